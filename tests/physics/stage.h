// Shared by the tests against the double-precision reference: scenes from JSON, and states in double.
#pragma once

#include <glm/geometric.hpp>
#include <string>

#include "server/reference/reference.h"
#include "server/sim/colliders.h"
#include "tests/scenes.h"

namespace clothlab {

inline scene::Scene scene_of(const std::string& text) {
  return test::document_of(text).scene;
}

inline scene::Scene preset(const std::string& name) {
  return scene::load_preset(name)->scene;
}

/// A cloth that falls onto another one, which is held at two edges.
inline scene::Scene two_sheets() {
  return scene_of(R"({"version": 1,
    "cloths": [{"mesh": {"grid": {"columns": 15, "rows": 15, "width": 0.28, "height": 0.28}},
                "mass": {"per_vertex": 0.001},
                "material": {"structural": 200, "shear": 100, "bend": 20, "damping": 0.02},
                "pins": [{"at": "edge:row:0"}, {"at": "edge:row:14"}]},
               {"mesh": {"grid": {"columns": 12, "rows": 12, "width": 0.2, "height": 0.2}},
                "transform": {"translate": [0.013, 0.05, 0.037], "rotate": [0, 20, 0]},
                "mass": {"per_vertex": 0.002},
                "material": {"structural": 200, "shear": 100, "bend": 20, "damping": 0.02}}],
    "self_collision": {"thickness": 0.03, "friction": 0.4}})");
}

/// The same scene for the double-precision reference.
inline reference::World world_of(const scene::Scene& scene) {
  return *reference::make_world(scene, sim::contact_margins(scene, *model::build(scene)));
}

/// The reference's state from the GPU's: the same numbers, in double.
inline reference::State in_double(const sim::State& state, std::uint64_t step) {
  reference::State result;
  result.position.assign(state.position.begin(), state.position.end());
  result.velocity.assign(state.velocity.begin(), state.velocity.end());
  result.contacts.assign(state.position.size(), 0);
  result.step = step;
  return result;
}

}  // namespace clothlab
