// Bounds of how far a step in float32 may be from the same step in double, from the rounding of each
// operation.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "server/reference/reference.h"

namespace clothlab {

inline constexpr double unit_roundoff = 0x1p-24;  // of float32, round to nearest

struct Rounding {
  std::vector<double> position, velocity;  ///< [vertex_count] bounds of |error| in one step [m], [m/s]
};

/// Bounds for the step from `before` to `after` with springs, gravity, drag and pins.
/// A spring's length and direction each come from a difference, a dot product, a square root and a division:
/// GLSL 4.5 (section 4.7.1) lets these four add up to 8 roundings; stiffness, rest length and damping are
/// rounded once each.
inline Rounding step_rounding(const reference::World& world, const reference::State& before,
                              const reference::State& after) {
  const double u = unit_roundoff, dt = world.scene.solver.dt;
  const std::size_t count = before.position.size();
  std::vector<double> force_error(count, 0.0), force_sum(count, 0.0);
  for (const model::Spring& spring : world.model.springs()) {
    const auto [a, b] = spring.vertices;
    const double k = spring.law.stiffness;
    const double length = glm::distance(before.position[a], before.position[b]);
    const double damping = spring.law.damping * glm::distance(before.velocity[a], before.velocity[b]);
    const double tension = k * std::abs(length - spring.law.rest_length) + damping;
    for (const std::uint32_t vertex : {spring.vertices[0], spring.vertices[1]}) {
      force_error[vertex] +=
          u * (8 * k * length + 2 * k * spring.law.rest_length + 10 * damping + 10 * tension);
      force_sum[vertex] += tension;
    }
  }
  Rounding bound{std::vector<double>(count), std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const double x = glm::length(before.position[i]) + glm::length(after.position[i]);
    const double v = glm::length(before.velocity[i]) + glm::length(after.velocity[i]);
    if (world.model.pin_motion[i] !=
        model::not_pinned) {  // a pose in float32: 3 products and sums per component
      bound.position[i] = 4 * u * x;
      bound.velocity[i] = 4 * u * (v + x);
      continue;
    }
    const double mass = world.model.mass[i];
    const double field = glm::length(world.scene.gravity) + world.scene.air_drag * v;
    // Summing at most 12 springs, then mass, gravity, drag and dt: each term is rounded at most 16 times.
    const double acceleration = force_error[i] / mass + 16 * u * (force_sum[i] / mass + field);
    bound.velocity[i] = dt * acceleration + u * v;
    bound.position[i] = dt * bound.velocity[i] + u * (x + 2 * dt * v);
  }
  return bound;
}

}  // namespace clothlab
