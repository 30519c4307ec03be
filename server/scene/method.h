// The methods of time stepping: their names and how they differ. Code that treats methods differently reads
// this table; the formulas of a method stand where they are used (step limits, growth factors, kernels).
#pragma once

#include <array>
#include <optional>
#include <string>

namespace clothlab::scene {

enum class Method { explicit_euler, symplectic_euler, verlet, rk4, implicit_euler, pbd, xpbd, vbd, bdf2 };

/// The kind of iteration that `solver.iterations` counts.
enum class Iterations { none, newton_steps, spring_sweeps, vertex_sweeps };

struct MethodFacts {
  Method method;
  const char* name;           ///< in the document, on the command line and in the protocol
  int order;                  ///< the error of a run shrinks as dt^order
  int evaluations;            ///< of all forces in one time step, iterations not counted
  Iterations iterations;      ///< in one time step
  bool needs_midpoint_poses;  ///< a step also needs the poses of moving pins at its middle
};

/// One entry for each method, in the order of `Method`.
inline constexpr std::array method_table{
    MethodFacts{Method::explicit_euler, "explicit_euler", 1, 1, Iterations::none, false},
    MethodFacts{Method::symplectic_euler, "symplectic_euler", 1, 1, Iterations::none, false},
    MethodFacts{Method::verlet, "verlet", 2, 1, Iterations::none, false},
    MethodFacts{Method::rk4, "rk4", 4, 4, Iterations::none, true},
    MethodFacts{Method::implicit_euler, "implicit_euler", 1, 1, Iterations::newton_steps, false},
    MethodFacts{Method::pbd, "pbd", 1, 1, Iterations::spring_sweeps, false},
    MethodFacts{Method::xpbd, "xpbd", 1, 1, Iterations::spring_sweeps, false},
    MethodFacts{Method::vbd, "vbd", 1, 1, Iterations::vertex_sweeps, false},
    MethodFacts{Method::bdf2, "bdf2", 2, 1, Iterations::newton_steps, false},
};

/// All methods, in the order in which they are listed to a user.
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
/// True if the method makes Gauss-Seidel sweeps over springs or vertices, one colour after the other.
constexpr bool sweeps(Method method) {
  return facts(method).iterations == Iterations::spring_sweeps ||
         facts(method).iterations == Iterations::vertex_sweeps;
}
constexpr bool sweeps_vertices(Method method) {
  return facts(method).iterations == Iterations::vertex_sweeps;
}
/// True if the method solves linear equations, to the accuracy `solver.tolerance`.
constexpr bool solves(Method method) {
  return facts(method).iterations == Iterations::newton_steps;
}
/// The share of a step after which a method with one evaluation of outer forces takes them: those that
/// iterate look for the state at the step's end. The stages of the others have times of their own, or are at
/// the step's start.
constexpr double forces_after(Method method) {
  return iterates(method) ? 1.0 : 0.0;
}
/// True if the method is stable at any time step. This holds for all methods that iterate, and for no others.
constexpr bool any_step_is_stable(Method method) {
  return iterates(method);
}

/// The value of `solver.method` in a document that sets Solver::automatic.
inline constexpr const char* automatic_method = "auto";

/// The method of that name, if there is one.
std::optional<Method> method_of(const std::string& name);

}  // namespace clothlab::scene
