// The shape of rest as a measure of accuracy, for scenes whose motion is chaotic: the scene settles in air so
// thick that the cloth soon comes to rest, and is then compared with the shape at which the reference's
// forces balance.
#pragma once

#include <optional>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

struct Settling {
  scene::Scene scene;             ///< the scene with the thick air
  double time = 0;                ///< simulated time after which the cloth counts as at rest [s]
  std::vector<glm::dvec3> shape;  ///< [vertex] the shape of rest, where all forces balance [m]
  double reference_error = 0;     ///< RMS distance of the reference to `shape` after `time`, over the size
};

/// Finds the shape of rest. `size` [m] is the cloth's size, `budget` [s] the wall time allowed for settling
/// the reference. Error: why no such shape can be had (a pin moves, ...) and what to do; or cancelled.
Result<Settling> settle(const reference::World& world, double size, double budget,
                        const std::stop_token& stop);

/// Runs `scene`, which is `settling.scene` with any setting, for the settling time. Returns the RMS distance
/// to the shape of rest as a share of `size`; none if the run blew up.
Result<std::optional<double>> rest_error(const Settling& settling, const scene::Scene& scene, double size,
                                         TrialRunner& trials, const std::stop_token& stop);

}  // namespace clothlab::lab
