#include "server/scene/method.h"

#include <algorithm>

namespace clothlab::scene {

const char* name(Method method) {
  switch (method) {
    case Method::explicit_euler:
      return "explicit_euler";
    case Method::symplectic_euler:
      return "symplectic_euler";
    case Method::verlet:
      return "verlet";
    case Method::rk4:
      return "rk4";
    case Method::implicit_euler:
      return "implicit_euler";
  }
  return "";
}

std::optional<Method> method_of(const std::string& wanted) {
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](Method method) { return name(method) == wanted; });
  return found == methods.end() ? std::nullopt : std::optional(*found);
}

}  // namespace clothlab::scene
