// Measures how much the springs of a simulation are stretched.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "server/sim/simulation.h"

namespace clothlab::test {

/// Length of the longest spring over its rest length, less 1. Stretch alone: max_strain counts compression,
/// too.
inline double largest_stretch(sim::Simulation& simulation) {
  const sim::State state = simulation.read_state();
  double largest = 0.0;
  for (const model::Spring& spring : simulation.model().springs()) {
    const glm::dvec3 a = state.position[spring.vertices[0]], b = state.position[spring.vertices[1]];
    largest = std::max(largest, glm::distance(a, b) / spring.law.rest_length - 1.0);
  }
  return largest;
}

}  // namespace clothlab::test
