#include "server/lab/measure/sizes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::lab {

double largest_strain(const reference::World& world, const reference::State& state) {
  double most = 0.0;
  model::each_element(world.model.elements, [&](const auto& element) {
    most = std::max(most, element_strain(element.law, edges(element, 0, state.position)));
  });
  return most;
}

reference::Energy energy_of_free(const reference::World& world, const reference::State& state) {
  reference::Energy sum = reference::energy(world, state);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (!world.pinned(i)) continue;
    const double mass = world.model.mass[i];
    sum.kinetic -= 0.5 * mass * glm::dot(state.velocity[i], state.velocity[i]);
    sum.gravitational += mass * glm::dot(world.scene.gravity, state.position[i]);
  }
  return sum;
}

}  // namespace clothlab::lab
