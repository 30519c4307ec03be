#include "server/lab/measure/second_look.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/lab/measure/control.h"
#include "server/reference/follower.h"

namespace clothlab::lab {

namespace {

constexpr int most_looks = 96, fewest_looks = 24;  // times at which one setting is compared
constexpr double most_positions = 2e6;             // vertex positions kept for all settings together

/// The motion of one setting, at the times at which it is compared.
struct Path {
  std::vector<double> time;                      ///< [s]
  std::vector<std::vector<glm::vec3>> position;  ///< [look][vertex] [m]
  std::vector<double> error;                     ///< [look] RMS position error over the cloth's size
  bool every_step = true;                        ///< there is a look at every step
};

Result<Path> record(scene::Scene scene, const Truth& truth, int looks, TrialRunner& trials,
                    const std::stop_token& stop) {
  const int steps = steps_to_horizon(scene.solver.dt, truth);
  const double horizon = truth.spacing * samples_to_horizon;
  scene.solver.dt = horizon / steps;
  const Result<sim::Simulation*> simulation = trials.prepare(scene);
  if (!simulation) return simulation.error();
  Path path;
  const int stride = (steps + looks - 1) / looks;
  path.every_step = stride == 1;
  for (int done = 0; done < steps;) {
    if (stop.stop_requested()) return cancelled;
    const int count = std::min(stride, steps - done);
    (*simulation)->step(static_cast<std::uint32_t>(count));
    (*simulation)->finish();
    done += count;
    path.time.push_back(horizon * done / steps);
    path.position.push_back((*simulation)->read_state().position);
  }
  return path;
}

double rms(const std::vector<glm::vec3>& position, const std::vector<glm::dvec3>& exact) {
  double sum = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const glm::dvec3 off = glm::dvec3(position[i]) - exact[i];
    sum += glm::dot(off, off);
  }
  return std::sqrt(sum / static_cast<double>(exact.size()));
}

/// Runs the reference through every time of every path and fills in the paths' errors. False: cancelled.
bool compare(std::vector<Path>& paths, const Truth& truth, const std::stop_token& stop) {
  reference::Follower follower(truth.world, truth.pace, stop);
  reference::State state = reference::at_rest(truth.world);
  const double same = 1e-9 * truth.spacing;  // times closer than this [s] differ only by rounding
  for (double now = 0.0;;) {
    double next = INFINITY;
    for (const Path& path : paths)
      if (path.error.size() < path.position.size()) next = std::min(next, path.time[path.error.size()]);
    if (std::isinf(next)) return true;
    if (!follower.follow(state, now, next)) return false;
    for (Path& path : paths)
      if (path.error.size() < path.position.size() && path.time[path.error.size()] <= next + same)
        path.error.push_back(rms(path.position[path.error.size()], state.position) / truth.size);
    now = next;
  }
}

/// The path's largest error; none if the setting blew up.
std::optional<LargestError> largest(const Path& path, const Truth& truth) {
  LargestError result;
  double before = 0.0, jump = 0.0;  // the error is 0 at the start
  for (const double error : path.error) {
    if (!std::isfinite(error)) return std::nullopt;
    result.seen = std::max(result.seen, error);
    jump = std::max(jump, std::abs(error - before));
    before = error;
  }
  const double reference_error = truth.position_error / truth.size;
  result.low = std::max(0.0, result.seen - reference_error);
  result.high = result.seen + reference_error + (path.every_step ? 0.0 : 0.5 * jump);
  return result;
}

}  // namespace

Result<std::vector<std::optional<LargestError>>> measure_largest_errors(const scene::Scene& scene,
                                                                        const Truth& truth,
                                                                        const std::vector<Setting>& settings,
                                                                        TrialRunner& trials,
                                                                        const std::stop_token& stop) {
  const double vertices = static_cast<double>(truth.world.model.vertex_count());
  const int looks = std::clamp(
      static_cast<int>(most_positions /
                       (vertices * static_cast<double>(std::max<std::size_t>(1, settings.size())))),
      fewest_looks, most_looks);
  std::vector<Path> paths;
  for (const Setting& setting : settings) {
    Result<Path> path = record(with(scene, setting), truth, looks, trials, stop);
    if (!path) return path.error();
    paths.push_back(std::move(*path));
  }
  if (!compare(paths, truth, stop)) return cancelled;
  std::vector<std::optional<LargestError>> errors;
  for (const Path& path : paths) errors.push_back(largest(path, truth));
  return errors;
}

}  // namespace clothlab::lab
