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
    case Method::pbd:
      return "pbd";
    case Method::xpbd:
      return "xpbd";
    case Method::vbd:
      return "vbd";
  }
  return "";
}

bool sweeps(Method method) {
  return method == Method::pbd || method == Method::xpbd || method == Method::vbd;
}

bool any_step_is_stable(Method method) {
  return method == Method::implicit_euler || sweeps(method);
}

std::optional<Method> method_of(const std::string& wanted) {
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](Method method) { return name(method) == wanted; });
  return found == methods.end() ? std::nullopt : std::optional(*found);
}

}  // namespace clothlab::scene
