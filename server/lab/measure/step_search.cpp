#include "server/lab/measure/step_search.h"

#include <algorithm>
#include <cmath>

#include "server/lab/measure/control.h"
#include "server/model/element_operator.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"

namespace clothlab::lab {

namespace {

using scene::Method;

constexpr double longest_smooth_step =
    1.0 / 30;                                // longest step tried [s]: 30 states a second still look smooth
constexpr double runner_up_cost_limit = 20;  // times the best: a runner-up that costs more is not searched
/// A step predicted by the method's order may be too short by this factor before the search gives up: the
/// order need not hold at long steps.
constexpr double order_slack = 2.0;
constexpr double most_a_run = 8.0;           // largest expected wall time of one run [s]
constexpr int estimate_rounds = 3;           // brief timings of each candidate
constexpr double estimate_wall_time = 0.03;  // wall time of one of these timings at most [s]

/// The settings tried with a method, their steps not yet chosen.
std::vector<Setting> settings_of(Method method) {
  if (scene::solves(method))
    return {{method, 0, 1, 1e-4}, {method, 0, 1, 1e-6}, {method, 0, 2, 1e-4}, {method, 0, 4, 1e-4}};
  if (!scene::sweeps(method)) return {{method, 0, 1, 1e-4}};
  std::vector<Setting> settings;
  for (const int iterations : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32})
    settings.push_back({method, 0, iterations, 1e-4});
  return settings;
}

}  // namespace

double StepSearch::limit_of(Method method) const {
  return model::dt_limit(method, truth_.world.model, scene_);
}

Status StepSearch::list(const std::vector<Method>& wanted) {
  const Result<std::vector<Method>> methods = scene::suited_methods(scene_, wanted);
  if (!methods) return methods.error();
  for (const Method method : *methods) {
    const double limit = limit_of(method);
    if (limit == 0.0) {
      notes_.push_back(std::string(scene::name(method)) + " is stable at no step here.");
      continue;
    }
    for (Setting setting : settings_of(method)) {
      setting.dt = std::min({model::margin_to_warn * limit, truth_.horizon / 8, longest_smooth_step});
      setting.dt = fitted_dt(setting.dt, truth_);
      candidates_.push_back({setting, limit, worst, {}});
    }
  }
  if (candidates_.empty())
    return Error{"methods", "none of them is stable at any step here", "other methods, or damping"};
  if (Status estimated = estimate_costs(); !estimated) return estimated;
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    const bool a_free = std::isinf(a.limit), b_free = std::isinf(b.limit);
    return a_free != b_free ? b_free : a.cost(a.setting.dt) < b.cost(b.setting.dt);
  });
  return ok();
}

/// Estimates what a step of each candidate costs: the smallest of a few short timings, taken in turns.
Status StepSearch::estimate_costs() {
  std::vector<scene::Scene> scenes;
  for (const Candidate& candidate : candidates_) scenes.push_back(with(scene_, candidate.setting));
  Result<std::vector<std::vector<double>>> times =
      trials_.time(scenes, truth_.horizon, estimate_wall_time, estimate_rounds, stop_);
  if (!times) return times.error();
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    candidates_[i].step_cost = cost_of((*times)[i]).minimum * candidates_[i].setting.dt / 1000.0;
  return ok();
}

Result<double> StepSearch::error_at(Candidate& candidate, double dt, Point& point) {
  point = {};
  point.setting = candidate.setting;
  point.setting.dt = fitted_dt(dt, truth_);
  const Result<Trial> trial = trials_.run(with(scene_, point.setting), truth_, truth_.horizon, stop_);
  if (!trial) return trial.error();
  point.error = trial->error;
  point.largest_position_error = trial->largest_position_error;
  point.blew_up_at = trial->blew_up_at;
  if (std::isfinite(candidate.limit)) point.dt_over_limit = point.setting.dt / candidate.limit;
  if (!point.blew_up_at) {
    const double cost = 1000.0 * trial->wall / trial->simulated;
    point.cost = Cost{cost, cost, 1};
    candidate.step_cost = std::min(candidate.step_cost, cost * point.setting.dt / 1000.0);
  }
  tried_.push_back(point);
  return point.largest_position_error && std::isfinite(*point.largest_position_error)
             ? *point.largest_position_error
             : worst;
}

/// The cost [ms per simulated second] up to which a setting of the method is of interest: that of the best so
/// far if `method` has the best, else that of the runner-up, which is the best of the other methods, but at
/// most `runner_up_cost_limit` times the best.
double StepSearch::of_interest(Method method) const {
  double best = worst, other = worst;
  Method best_method = method;
  for (const Candidate& candidate : candidates_)
    if (candidate.best && candidate.best->cost->median < best) {
      best = candidate.best->cost->median;
      best_method = candidate.setting.method;
    }
  if (best_method == method) return best;
  for (const Candidate& candidate : candidates_)
    if (candidate.best && candidate.setting.method != best_method)
      other = std::min(other, candidate.best->cost->median);
  return std::min(other, runner_up_cost_limit * best);
}

/// True if the cost `most` [ms per simulated second] is below 3 times the best so far. A search then begins
/// at the step that costs `most`, as one run there shows whether the candidate can compete.
bool StepSearch::cost_bound_is_close(double most) const {
  double best = worst;
  for (const Candidate& candidate : candidates_)
    if (candidate.best) best = std::min(best, candidate.best->cost->median);
  return most < 3.0 * best;
}

Status StepSearch::search(Candidate& candidate) {
  const double most = close_race * of_interest(candidate.setting.method);
  const double longest = candidate.setting.dt;
  Point point;
  double kept = 0.0, missed = worst;
  const double dearest = 1000.0 * candidate.step_cost / most;  // shorter steps cost more than `most` [s]
  for (double dt = cost_bound_is_close(most) ? std::min(longest, dearest) : longest; kept == 0.0;) {
    if (candidate.cost(longest) > most || candidate.step_cost * truth_.horizon / dt > most_a_run) return ok();
    const Result<double> error = error_at(candidate, dt, point);
    if (!error) return error.error();
    if (*error <= tolerance_) {
      kept = point.setting.dt;
      keep(candidate, point);
      break;
    }
    missed = point.setting.dt;
    const double hoped =
        missed * 0.95 * std::pow(tolerance_ / *error, 1.0 / scene::facts(candidate.setting.method).order);
    if (hoped * order_slack < dearest || dt <= dearest) return ok();
    dt = std::clamp(hoped, missed / 16, missed / 1.3);
  }
  if (missed == worst && kept < longest) missed = search_precision * longest;  // `longest` itself may be good
  // Between a step that keeps the tolerance and one that misses it, tries the step that the method's order
  // predicts, then the geometric mean.
  double dt = kept * std::pow(tolerance_ / *candidate.best->largest_position_error,
                              1.0 / scene::facts(candidate.setting.method).order);
  while (kept < longest / search_precision && missed > search_precision * kept) {
    if (!(dt > kept * std::sqrt(search_precision) && dt < missed / std::sqrt(search_precision)))
      dt = std::sqrt(kept * missed);
    const Result<double> error = error_at(candidate, std::min(dt, longest), point);
    if (!error) return error.error();
    if (point.setting.dt <= kept || point.setting.dt >= missed) break;  // no other step lies between
    if (*error <= tolerance_) {
      kept = point.setting.dt;
      keep(candidate, point);
    } else {
      missed = point.setting.dt;
    }
    dt = std::sqrt(kept * missed);
  }
  return ok();
}

Result<double> StepSearch::shorten(Candidate& candidate, double too_large) {
  const double dt =
      candidate.best->setting.dt *
      std::clamp(0.97 * std::pow(tolerance_ / too_large, 1.0 / scene::facts(candidate.setting.method).order),
                 0.25, 0.97);
  return step_at(candidate, dt);
}

Result<double> StepSearch::step_at(Candidate& candidate, double dt) {
  Point point;
  const Result<double> error = error_at(candidate, dt, point);
  if (error && *error < worst) keep(candidate, point);
  return error;
}

void StepSearch::keep(Candidate& candidate, const Point& point) const {
  candidate.best = point;
  candidate.best->cost = Cost{candidate.cost(point.setting.dt), candidate.cost(point.setting.dt), 1};
}

}  // namespace clothlab::lab
