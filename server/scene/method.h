// The methods of time stepping: what they are called and what sets each apart. Whoever asks which method it
// is reads this table; formulas of a method are where they are used (limits, factors of growth, kernels).
#pragma once

#include <array>
#include <optional>
#include <string>

#include "server/scene/scene.h"

namespace clothlab::scene {

/// What `solver.iterations` counts.
enum class Iterations { none, newton_steps, spring_sweeps, vertex_sweeps };

struct MethodFacts {
  Method method;
  const char* name;          ///< as the document, the command line and the protocol spell it
  int order;                 ///< of the error in dt
  int evaluations;           ///< of all forces, in a step before any iteration
  Iterations iterations;     ///< a time step
  bool looks_at_the_middle;  ///< at where pins and colliders are in the middle of the step
};

/// In the order of `Method`.
inline constexpr std::array method_table{
    MethodFacts{Method::explicit_euler, "explicit_euler", 1, 1, Iterations::none, false},
    MethodFacts{Method::symplectic_euler, "symplectic_euler", 1, 1, Iterations::none, false},
    MethodFacts{Method::verlet, "verlet", 2, 1, Iterations::none, false},
    MethodFacts{Method::rk4, "rk4", 4, 4, Iterations::none, true},
    MethodFacts{Method::implicit_euler, "implicit_euler", 1, 1, Iterations::newton_steps, false},
    MethodFacts{Method::pbd, "pbd", 1, 1, Iterations::spring_sweeps, false},
    MethodFacts{Method::xpbd, "xpbd", 1, 1, Iterations::spring_sweeps, false},
    MethodFacts{Method::vbd, "vbd", 1, 1, Iterations::vertex_sweeps, false},
};

/// All there are, in the order in which they are listed to a user.
inline constexpr auto methods = [] {
  std::array<Method, method_table.size()> list{};
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = method_table[i].method;
  return list;
}();

constexpr const MethodFacts& facts(Method method) {
  return method_table[static_cast<std::size_t>(method)];
}
/// "symplectic_euler", ...
constexpr const char* name(Method method) {
  return facts(method).name;
}
constexpr bool iterates(Method method) {
  return facts(method).iterations != Iterations::none;
}
/// Gauss-Seidel sweeps over springs or vertices, colour by colour.
constexpr bool sweeps(Method method) {
  return facts(method).iterations == Iterations::spring_sweeps ||
         facts(method).iterations == Iterations::vertex_sweeps;
}
constexpr bool sweeps_vertices(Method method) {
  return facts(method).iterations == Iterations::vertex_sweeps;
}
/// Linear equations, to `solver.tolerance`.
constexpr bool solves(Method method) {
  return facts(method).iterations == Iterations::newton_steps;
}
/// No length of step makes the method blow up: so it is with all that iterate, and no other.
constexpr bool any_step_is_stable(Method method) {
  return iterates(method);
}

/// What a document says instead of a method for Solver::automatic.
inline constexpr const char* automatic_method = "auto";

/// The method of that name, if there is one.
std::optional<Method> method_of(const std::string& name);

}  // namespace clothlab::scene
