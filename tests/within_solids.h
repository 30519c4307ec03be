// How deep vertices are in solids.
#pragma once

#include <algorithm>

#include "server/scene/solid.h"
#include "server/sim/simulation.h"
#include "tests/solids.h"

namespace clothlab::test {

/// How deep the deepest vertex that no pin holds is in a solid [m]; -1 if all are outside.
inline double deepest_in_solids(const sim::Simulation& simulation, const sim::State& state) {
  double found = -1.0;
  for (const scene::Collider& collider : simulation.colliders_now()) {
    if (collider.shape.index() >= scene::solid_kinds) continue;
    for (std::size_t i = 0; i < state.position.size(); ++i)
      if (simulation.model().pin_motion[i] == model::not_pinned)
        if (const double at = depth(collider.shape, model::dvec3(state.position[i])); at > 0.0)
          found = std::max(found, at);
  }
  return found;
}

}  // namespace clothlab::test
