#include "server/lab/measure/ladder.h"

#include <algorithm>
#include <cmath>

#include "server/model/element_operator.h"
#include "server/model/stability.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

using scene::Method;

constexpr double beyond = 1.05, within = 0.95;  // of the limit: the first step should blow up, the next hold
constexpr double no_better = 0.9;  // of the least error so far: with a larger error, a step was not worth it
constexpr int most_no_better = 2;  // such steps in a row end a ladder: float32 or the reference is the limit
constexpr int most_unknown = 6;    // more steps without a known error end it; they only show the cost

std::vector<int> iterations_of(Method method, const ChartRequest& request) {
  if (!iterates(method)) return {1};
  if (!request.iterations.empty()) return request.iterations;
  if (scene::solves(method)) return {1, 4};
  return {1, 4, 16};
}

/// The longest step that is tried, even where the limit is longer or there is none [s].
double longest_step(const Truth& truth) {
  const double whole = truth.horizon > 0.0 ? truth.horizon : truth.time;
  return std::min(1.0 / 15, whole / 8);
}

}  // namespace

void Ladder::go_on(std::optional<double> error, std::optional<double> reference_error) {
  const bool first = std::isfinite(limit) && limit > 0.0 && next.dt > within * limit;
  next.dt = first ? std::min(within * limit, next.dt / 1.01) : next.dt / step_ratio;
  if (first) return;  // its error says nothing of how errors fall with dt
  if (!error) {
    done = ++steps_without_gain > most_unknown;
    return;
  }
  steps_without_gain = *error < no_better * least_error ? 0 : steps_without_gain + 1;
  least_error = std::min(least_error, *error);
  if (steps_without_gain >= most_no_better && least_error < 0.1) done = true;
  if (reference_error && *error < *reference_error) done = true;
}

double limit_of(Method method, const scene::Scene& scene, const Truth& truth) {
  return model::dt_limit(method, truth.world.model, scene);
}

std::vector<Ladder> make_ladders(const scene::Scene& scene, const ChartRequest& request, const Truth& truth) {
  std::vector<Ladder> ladders;
  const double a_step = 2e-7 * truth.world.model.vertex_count();  // wall time of a step [s], a first guess
  for (const Method method : request.methods) {
    for (const int iterations : iterations_of(method, request)) {
      Ladder ladder;
      // With a tolerance of 1e-4, small steps would be solved without any iteration, and that error adds up.
      ladder.next = {method, longest_step(truth), iterations, scene::solves(method) ? 1e-6 : 1e-4};
      ladder.limit = limit_of(method, scene, truth);
      ladder.step_cost = a_step * (scene::solves(method)   ? 100.0 * iterations
                                   : scene::sweeps(method) ? 1.0 + 1.5 * iterations
                                                           : scene::facts(method).evaluations);
      if (ladder.limit == 0.0) {  // unstable at any dt, but useful while the growth is small
        const double omega = 2.0 / limit_of(Method::symplectic_euler, scene, truth);
        ladder.next.dt = std::min(24.0 / (omega * omega * truth.time), longest_step(truth));
      } else if (std::isfinite(ladder.limit)) {
        ladder.next.dt = std::min(beyond * ladder.limit, longest_step(truth));
      }
      ladders.push_back(ladder);
    }
  }
  return ladders;
}

}  // namespace clothlab::lab
