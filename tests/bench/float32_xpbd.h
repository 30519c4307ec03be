// XPBD in float32 as most write it: it moves positions and takes the velocity from their difference, v = (x -
// x_prev) / dt. Clothlab's kernel does not (shaders/methods/deviation.glsl): this shows the difference. On
// the CPU, with one iteration and no contacts.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "server/model/constraint_gains.h"
#include "server/reference/reference.h"

namespace clothlab::bench {

inline std::vector<glm::dvec3> xpbd_by_differences(const reference::World& world, int steps) {
  const model::Model& model = world.model;
  const auto dt = static_cast<float>(world.scene.solver.dt);
  const glm::vec3 gravity(world.scene.gravity);
  std::vector<glm::vec3> x(model.rest_position.begin(), model.rest_position.end()), x_prev, v(x.size());
  std::vector<float> w(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    w[i] = world.pinned(i) ? 0.0f : static_cast<float>(1.0 / model.mass[i]);
  for (int n = 0; n < steps; ++n) {
    x_prev = x;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w[i] > 0.0f) x[i] += dt * (v[i] + dt * gravity);
    for (const std::uint32_t index : world.element_colours[0].order) {
      const model::Spring& spring = model.springs()[index];
      const float wa = w[spring.vertices[0]], wb = w[spring.vertices[1]];
      if (wa + wb == 0.0f) continue;
      const auto gain =
          static_cast<float>(model::constraint_gains(world.scene.solver, spring.law.stiffness,
                                                     spring.law.damping, static_cast<double>(wa + wb))
                                 .stretch);
      const glm::vec3 d = x[spring.vertices[0]] - x[spring.vertices[1]];
      const float length = glm::length(d);
      const glm::vec3 push = d * (-gain * (length - static_cast<float>(spring.law.rest_length)) / length);
      x[spring.vertices[0]] += wa * push;
      x[spring.vertices[1]] -= wb * push;
    }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - x_prev[i]) / dt;
  }
  return {x.begin(), x.end()};
}

}  // namespace clothlab::bench
