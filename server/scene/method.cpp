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

Method method_of(const std::string& wanted) {
  return *std::find_if(methods.begin(), methods.end() - 1,
                       [&](Method method) { return name(method) == wanted; });
}

}  // namespace clothlab::scene
