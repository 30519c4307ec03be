// What a simulation has that depends on the scene's structure but not on the state: the passes that step it
// and the arrays they read. A change of structure replaces it as a whole, a change of numbers updates it.
#pragma once

#include <memory>
#include <optional>

#include "server/sim/integrator.h"
#include "server/sim/strain_limit.h"

namespace clothlab::sim {

struct Kernels {
  Plan plan;
  model::Model model;
  MotionTable motions;
  std::optional<SelfCollision> self_collision;
  gl::TextureBuffer elements, slices;
  std::unique_ptr<Integrator> integrator;
  std::optional<StrainLimit> strain_limit;

  /// For a state that none of its steps made yet.
  static Result<Kernels> create(const scene::Scene& scene);

  /// Takes over the numbers of a scene with the same structure; `material_changed`: that of any cloth.
  Status update(const scene::Scene& scene, bool material_changed);

  /// Brings the neighbour lists up to date, with more room where they need it: none of a step's pairs is left
  /// out as long as that is to be had. There must be lists; may stop on its way.
  Work update_lists(const scene::Scene& scene);

  Surroundings surroundings(const scene::Scene& scene) const {
    return {scene, model, motions, self_collision ? &*self_collision : nullptr};
  }
};

}  // namespace clothlab::sim
