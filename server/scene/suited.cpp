#include "server/scene/suited.h"

#include <algorithm>
#include <string>
#include <variant>

namespace clothlab::scene {

const char* unsuited(Method method, const Scene& scene) {
  const bool sheet = std::any_of(scene.cloths.begin(), scene.cloths.end(), [](const Cloth& cloth) {
    return std::holds_alternative<Fem>(cloth.material);
  });
  if (!sheet || method != Method::pbd) return nullptr;
  return "another method where a cloth has \"model\": \"fem\": PBD's stiffness is no N/m; \"xpbd\" is like "
         "it and keeps "
         "the material";
}

Result<std::vector<Method>> suited_methods(const Scene& scene, const std::vector<Method>& wanted) {
  std::vector<Method> suited;
  for (const Method method : methods) {
    const char* reason = unsuited(method, scene);
    if (!reason) suited.push_back(method);
    if (reason && std::find(wanted.begin(), wanted.end(), method) != wanted.end())
      return Error{"methods", name(method), reason};
  }
  return wanted.empty() ? suited : wanted;
}

}  // namespace clothlab::scene
