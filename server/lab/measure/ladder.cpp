#include "server/lab/measure/ladder.h"

#include <algorithm>
#include <cmath>

#include "server/model/element_operator.h"
#include "server/model/stability.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

using scene::Method;

constexpr double beyond = 1.05, within = 0.95;  // of the step limit: a cross and the first point
constexpr double no_better = 0.9;               // of the error before: a shorter step was not worth it
constexpr int most_no_better = 2;  // such steps in a row: float32 or the reference has the word now
constexpr int most_unknown = 6;    // steps without a known error: they show what it costs

std::vector<int> iterations_of(Method method, const ChartRequest& request) {
  if (!iterates(method)) return {1};
  if (!request.iterations.empty()) return request.iterations;
  if (scene::solves(method)) return {1, 4};
  return {1, 4, 16};
}

/// The longest step that is tried where no limit says it [s].
double longest_step(const Truth& truth) {
  const double whole = truth.horizon > 0.0 ? truth.horizon : truth.time;
  return std::min(1.0 / 15, whole / 8);
}

}  // namespace

void Ladder::go_on(std::optional<double> error, std::optional<double> own) {
  const bool first = std::isfinite(limit) && limit > 0.0 && next.dt > within * limit;
  next.dt = first ? std::min(within * limit, next.dt / 1.01) : next.dt / rung;
  if (first) return;  // tells of the limit, not of the order
  if (!error) {
    done = ++risen > most_unknown;
    return;
  }
  risen = *error < no_better * least_error ? 0 : risen + 1;
  least_error = std::min(least_error, *error);
  if (risen >= most_no_better && least_error < 0.1) done = true;
  if (own && *error < *own) done = true;
}

double limit_of(Method method, const scene::Scene& scene, const Truth& truth) {
  return model::dt_limit(method,
                         model::ElementOperator(truth.world.model, scene, truth.world.model.rest_position));
}

std::vector<Ladder> make_ladders(const scene::Scene& scene, const ChartRequest& request, const Truth& truth) {
  std::vector<Ladder> ladders;
  std::vector<Method> methods = request.methods;
  if (methods.empty()) methods.assign(scene::methods.begin(), scene::methods.end());
  const double a_step = 2e-7 * truth.world.model.vertex_count();  // a guess, to begin with
  for (const Method method : methods) {
    for (const int iterations : iterations_of(method, request)) {
      Ladder ladder;
      // Small steps are met by no iteration at all with 1e-4, which adds up.
      ladder.next = {method, longest_step(truth), iterations, scene::solves(method) ? 1e-6 : 1e-4};
      ladder.limit = limit_of(method, scene, truth);
      ladder.step_cost = a_step * (scene::solves(method)   ? 100.0 * iterations
                                   : scene::sweeps(method) ? 1.0 + 1.5 * iterations
                                                           : scene::facts(method).evaluations);
      if (ladder.limit == 0.0) {  // it grows at any step: as long as the growth stays small, it is of use
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
