// The shape of rest as a measure of accuracy, for scenes whose motion is chaotic: the scene let settle in air
// so thick that it comes to rest soon, against the reference's balance of forces.
#pragma once

#include <optional>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

struct Settling {
  scene::Scene scene;             ///< with the thick air
  double time = 0;                ///< after which it is taken to rest [s]
  std::vector<glm::dvec3> shape;  ///< [vertex] of rest [m]
  double reference_error = 0;     ///< how far the reference itself still is from it then, RMS over size
};

/// Error: why the scene has no such shape (pins or colliders that move, ...), what to do; or cancelled.
Result<Settling> settle(const reference::World& world, double size, double budget,
                        const std::stop_token& stop);

/// RMS distance to the shape of rest over `size`, after `scene` (a Settling's, stepped some way) has settled.
/// None: it blew up.
Result<std::optional<double>> rest_error(const Settling& settling, const scene::Scene& scene, double size,
                                         Bench& bench, const std::stop_token& stop);

}  // namespace clothlab::lab
