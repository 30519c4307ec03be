#include "server/lab/measure/floor.h"

#include <chrono>
#include <cmath>

#include "server/lab/measure/control.h"
#include "server/reference/trajectory.h"

namespace clothlab::lab {

Result<std::optional<double>> float32_floor(const scene::Scene& scene, const Truth& truth, double dt,
                                            double budget, TrialRunner& trials, const std::stop_token& stop) {
  const Setting setting{scene::Method::rk4, fitted_dt(dt, truth), 1, 1e-4};
  const scene::Scene stepped = with(scene, setting);
  Result<Trial> trial = trials.run(stepped, truth, truth.horizon, stop);
  if (!trial) return trial.error();
  if (trial->at_horizon.empty()) return std::optional<double>();
  reference::World world = truth.world;
  world.scene = stepped;
  reference::State state = reference::at_rest(world);
  const auto start = std::chrono::steady_clock::now();
  const int steps = steps_to_horizon(setting.dt, truth);
  for (int n = 0; n < steps; ++n) {
    if (stop.stop_requested()) return cancelled;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > budget)
      return std::optional<double>();
    reference::step(world, state);
  }
  const std::vector<glm::vec3>& read = trial->at_horizon;
  const double distance = reference::rms_distance({read.begin(), read.end()}, state.position);
  return std::optional<double>(distance / truth.size);
}

}  // namespace clothlab::lab
