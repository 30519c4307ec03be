// Backward Euler as an equation for the velocity u at the end of the step (Baraff & Witkin 1998, section 3),
// solved by Newton's method: to rounding, or by a given number of Newton steps from the velocity at its
// start. BDF2 is the same equation with another start and another time (shaders/methods/bdf2.glsl).
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/model/motion.h"
#include "server/reference/methods.h"
#include "server/reference/system.h"
#include "server/reference/vectors.h"
#include "server/reference/wind.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

constexpr double solved = 1e-13;   // residual over Equation::scale: a few hundred roundings
constexpr double rounded = 1e-10;  // below it a search that fails is rounding's
constexpr int most_newton_steps =
    200;  // far from the solution convergence is only linear, where the negative `across` is dropped

/// The equation r(u) = 0 at the free vertices, r(u) = M (1 + dt drag) u - M (v + dt g) - dt f(x + dt u, u),
/// for the velocity u at the end of the step [m/s]. The wind's force on a vertex is taken from the state at
/// the step's start, in the air at its end, and as linear in u: w - braking (u - v). So it adds to v and to
/// the drag.
struct Equation {
  const World& world;
  Vectors x, v;  ///< at the step's start [m], [m/s], with self-collision's push and impulse added;
                 ///< of BDF2, x_0 and v_0
  std::vector<double> drag;  ///< [vertex_count] of the air [1/s]
  Vectors pin_velocity;      ///< (position at the end - x) / dt of pinned vertices, 0 of free ones [m/s]
  double dt;
  Vectors first;  ///< the first estimate of the velocity at the step's end [m/s]

  /// `way`, `gain`: of the last step, for BDF2; empty: backward Euler.
  explicit Equation(const StepStart& start, const Vectors& way = {}, const Vectors& gain = {})
      : world(at_time(start.world, start.t + start.dt)),
        x(start.state.position),
        v(start.state.velocity),
        drag(x.size(), world.scene.air_drag),
        dt(way.empty() ? start.dt : 2.0 / 3.0 * start.dt),
        first(start.state.velocity) {
    const bool goes_on = !way.empty();
    const Vectors there = goes_on ? plus(x, 1.0, way) : x, as_fast = goes_on ? plus(v, 1.0, gain) : v;
    const std::vector<elements::WindLoad> wind = wind_loads(world, there, as_fast, start.t + start.dt);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double mass = world.model.mass[i];
      drag[i] += wind[i].braking / mass;
      if (goes_on) v[i] += 1.0 / 3.0 * gain[i];
      v[i] += start.impulse[i] + dt / mass * (wind[i].force + wind[i].braking * as_fast[i]);
      if (goes_on) x[i] += 1.0 / 3.0 * way[i];
      x[i] += start.push[i];
      first[i] += start.impulse[i];
    }
    Vectors unused(x.size());
    pin_velocity = x;
    place_pins(world, start.t + start.dt, pin_velocity, unused);
    for (std::size_t i = 0; i < x.size(); ++i) {
      pin_velocity[i] = (pin_velocity[i] - x[i]) / dt;
      if (world.pinned(i)) first[i] = pin_velocity[i];
    }
  }

  Vectors end(const Vectors& u) const {
    Vectors positions = x;
    for (std::size_t i = 0; i < x.size(); ++i) positions[i] += dt * u[i];
    return positions;
  }

  Vectors residual(const Vectors& u) const {
    const Vectors force = element_forces(world, end(u), u);
    Vectors r(x.size(), dvec3(0.0));
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (world.pinned(i)) continue;
      const double mass = world.model.mass[i];
      r[i] = mass * ((1.0 + dt * drag[i]) * u[i] - v[i] - dt * world.scene.gravity) - dt * force[i];
    }
    return r;
  }

  Matrix jacobian(const Vectors& u, Across across) const {
    Matrix matrix = system_matrix(world, end(u), {1.0, dt, dt * dt}, across);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = 3 * static_cast<Matrix::StorageIndex>(i) + axis;
        matrix.coeffRef(row, row) += world.model.mass[i] * dt * drag[i];
      }
    return matrix;
  }

  /// The largest sum of momenta in the equation of any vertex [kg m/s]; rounding errors are a share of it.
  double scale(const Vectors& u) const {
    Vectors sum(x.size());
    const Vectors positions = end(u);
    for (std::size_t i = 0; i < x.size(); ++i)
      sum[i].x = world.model.mass[i] *
                 (glm::length(u[i]) + glm::length(v[i]) + dt * glm::length(world.scene.gravity));
    model::each_element(world.model.elements, [&](const auto& element) {
      for (std::size_t corner = 0; corner < element.corners; ++corner)
        sum[element.vertices[corner]].x +=
            dt * element_force_scale(law_at(element, corner), edges(element, corner, positions),
                                     edges(element, corner, u));
    });
    double largest = 1e-300;
    for (const dvec3& s : sum) largest = std::max(largest, s.x);
    return largest;
  }

  /// The value that a line search lowers. Without damping it is the incremental potential [J], whose gradient
  /// is r. With damping there is no such potential, and it is |r|^2.
  double merit(const Vectors& u) const {
    const auto damped = [](const scene::Cloth& cloth) { return cloth.damping() > 0.0; };
    const std::vector<scene::Cloth>& cloths = world.scene.cloths;
    double sum = 0.0;
    if (std::any_of(cloths.begin(), cloths.end(), damped)) {
      for (const dvec3& r : residual(u)) sum += glm::dot(r, r);
      return sum;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (world.pinned(i)) continue;
      const dvec3 driven = v[i] + dt * world.scene.gravity;
      sum +=
          world.model.mass[i] * (0.5 * (1.0 + dt * drag[i]) * glm::dot(u[i], u[i]) - glm::dot(u[i], driven));
    }
    return sum + energy(world, State{end(u), Vectors(x.size(), dvec3(0.0)), {}}).elastic;
  }
};

/// The Newton step from u. With the true matrix it converges quadratically, but that matrix is not always
/// positive definite; the matrix without the negative part of compressed springs always is.
Vectors newton_step(const Equation& equation, const Vectors& u, const Vectors& r) {
  const Vectors wanted = plus(Vectors(u.size(), dvec3(0.0)), -1.0, r), still(u.size(), dvec3(0.0));
  Vectors du;
  if (!solve_with_pins(equation.world, equation.jacobian(u, Across::kept), wanted, still, du))
    solve_with_pins(equation.world, equation.jacobian(u, Across::dropped), wanted, still, du);
  return du;
}

/// The largest share 1, 1/2, 1/4, ... of du that lowers the merit; 0 if none does, as happens where only
/// rounding separates u from the solution.
double line_search(const Equation& equation, const Vectors& u, const Vectors& du) {
  const double before = equation.merit(u);
  for (double share = 1.0; share > 1e-6; share *= 0.5)
    if (equation.merit(plus(u, share, du)) < before) return share;
  return 0.0;
}

/// The state at the end of the step with velocity u.
State end_state(const StepStart& start, const Equation& equation, const Vectors& u) {
  State next = start.state;
  next.position = equation.end(u);
  next.velocity = u;
  next.residual = largest(equation.residual(u)) / equation.scale(u);
  return next;
}

State solved_end(const StepStart& start, const Equation& equation) {
  Vectors u = equation.v;
  for (std::size_t i = 0; i < u.size(); ++i)
    u[i] /= 1.0 + equation.dt * (equation.drag[i] - equation.world.scene.air_drag);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (start.world.pinned(i)) u[i] = equation.pin_velocity[i];
  const double scale = equation.scale(u);
  Vectors r = equation.residual(u), best = u;
  double least = largest(r);
  for (int n = 0; n < most_newton_steps && largest(r) > solved * scale; ++n) {
    const Vectors du = newton_step(equation, u, r);
    // Near the solution rounding hides the merit's decrease; the residual shows the progress better.
    Vectors next = plus(u, 1.0, du), r_next = equation.residual(next);
    if (!(largest(r_next) < 0.5 * largest(r))) {
      const double share = line_search(equation, u, du);
      if (share == 0.0 && largest(r) < rounded * scale) break;
      // The direction of a matrix without the negative `across` need not lower |r|^2. Taken whole, it still
      // leads to where the true matrix is positive definite.
      if (share > 0.0) {
        next = plus(u, share, du);
        r_next = equation.residual(next);
      }
    }
    u = next;
    r = r_next;
    if (largest(r) < least) {
      least = largest(r);
      best = u;
    }
  }
  return end_state(start, equation, best);
}

/// Whether the wind takes a vertex along within the step: it could take a quarter of the flow's speed in
/// it, and the vertex has gained more than that.
bool taken_along(const StepStart& start, const Vectors& gain) {
  const Equation equation(start, start.state.way, start.state.gain);
  const World& world = equation.world;
  const dvec3 air = model::wind_velocity(*world.scene.wind, start.t + start.dt);
  for (std::size_t i = 0; i < gain.size(); ++i) {
    const double by_wind = equation.drag[i] - world.scene.air_drag,
                 flow = glm::length(air - start.state.velocity[i]);
    if (!world.pinned(i) && start.dt * by_wind > 0.25 && glm::length(gain[i]) > 0.25 * flow) return true;
  }
  return false;
}

}  // namespace

State backward_euler(const StepStart& start) {
  return solved_end(start, Equation(start));
}

State bdf2(const StepStart& start) {
  return solved_end(start, Equation(start, start.state.way, start.state.gain));
}

bool note_step(const StepStart& start, State& next) {
  const World& world = start.world;
  const State& before = start.state;
  const double impact = 2.0 * start.dt * glm::length(world.scene.gravity);
  next.way = plus(next.position, -1.0, before.position);
  next.gain = plus(next.velocity, -1.0, before.velocity);
  bool smooth = true;
  for (std::size_t i = 0; i < next.gain.size(); ++i)
    smooth = smooth && (next.contacts[i] <= before.contacts[i] || glm::length(next.gain[i]) <= impact);
  if (world.scene.wind) smooth = smooth && !taken_along(start, next.gain);
  if (!smooth) next.way = next.gain = {};
  return smooth;
}

State limited_newton(const StepStart& start) {
  const Equation equation(start, start.state.way, start.state.gain);
  Vectors u = equation.first;
  for (int n = 0; n < start.world.scene.solver.iterations; ++n) {
    const Vectors r = equation.residual(u), still(u.size(), dvec3(0.0)), wanted = plus(still, -1.0, r);
    Vectors du;
    solve_with_pins(start.world, equation.jacobian(u, Across::dropped), wanted, still, du);
    u = plus(u, 1.0, du);
  }
  return end_state(start, equation, u);
}

}  // namespace clothlab::reference
