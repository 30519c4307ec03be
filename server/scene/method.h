// The names of the methods, as the scene document, the command line and the protocol spell them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "server/scene/scene.h"

namespace clothlab::scene {

/// All there are, in the order in which they are listed to a user.
inline constexpr std::array methods{Method::explicit_euler, Method::symplectic_euler,
                                    Method::verlet,         Method::rk4,
                                    Method::implicit_euler, Method::pbd,
                                    Method::xpbd,           Method::vbd};

/// What a document says instead of one of these for Solver::automatic.
inline constexpr const char* automatic_method = "auto";

/// Those that sweep over springs or vertices colour by colour: Gauss-Seidel iterations, `iterations` of them
/// a step.
bool sweeps(Method method);

/// No length of step makes the method blow up.
bool any_step_is_stable(Method method);

/// "symplectic_euler", ...
const char* name(Method method);

/// The method of that name, if there is one.
std::optional<Method> method_of(const std::string& name);

}  // namespace clothlab::scene
