#include "server/scene/method.h"

#include <algorithm>

namespace clothlab::scene {

namespace {
constexpr bool in_order() {
  for (std::size_t i = 0; i < methods.size(); ++i)
    if (methods[i] != static_cast<Method>(i)) return false;
  return true;
}
static_assert(in_order(), "`facts` looks a method up by its place");
}  // namespace

std::optional<Method> method_of(const std::string& wanted) {
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](Method method) { return name(method) == wanted; });
  return found == methods.end() ? std::nullopt : std::optional(*found);
}

}  // namespace clothlab::scene
