#include "server/lab/measure/chart.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/floor.h"
#include "server/lab/measure/ladder.h"
#include "server/lab/measure/settling.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"

namespace clothlab::lab {

namespace {

using Clock = std::chrono::steady_clock;
using scene::Method;

constexpr double share_of_truth = 0.3;         // share of the budget for the reference
constexpr double share_of_stiff_truth = 0.5;   // the same of a scene that is too stiff for RK4
constexpr double share_of_rest = 0.2;          // share of the budget kept for the errors of Axis::rest
constexpr double useless_error = 0.3;          // a point with a larger error is useless and timed only once
constexpr double dominated_cost_ratio = 20.0;  // a ladder is left out if other iterations cost this much less
constexpr double share_of_a_point = 1.0 / 25;  // share of the budget for one point at most
constexpr double late = 2.0;                   // a point is given up after so many times that
constexpr double timed = 0.15;                 // wall time of one timing at most [s]
constexpr int rounds_at_once = 3, rounds_later = 2;

class ChartMeasurement {
 public:
  ChartMeasurement(const scene::Scene& scene, const ChartRequest& request, const Control<Chart>& control)
      : scene_(scene), request_(request), control_(control), start_(Clock::now()) {}

  Result<Chart> run() {
    chart_.scene = scene_.name;
    chart_.renderer = gl::renderer_name();
    trials_.measure_convergence(true);
    if (Status computed = compute_truth(); !computed) return ended(computed.error());
    if (Status measured = measure_present(); !measured) return ended(measured.error());
    control_.arrived(chart_);
    if (Status bounded = compute_bounds(); !bounded) return ended(bounded.error());
    ladders_ = make_ladders(scene_, request_, truth_);
    while (Ladder* ladder = cheapest()) {
      if (Status measured = climb(*ladder); !measured) return ended(measured.error());
      control_.arrived(chart_);
    }
    if (Status settled = settle_points(); !settled) return ended(settled.error());
    if (Status timed_again = time_again(); !timed_again) return ended(timed_again.error());
    chart_.complete = true;
    control_.progress({1.0, 1.0, "done"});
    return chart_;
  }

 private:
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double left() const { return request_.budget - elapsed(); }

  /// The result after an error: the chart so far if the job was cancelled and has points, else the error.
  Result<Chart> ended(const Error& error) {
    if (!was_cancelled(error) || chart_.points.empty()) return error;
    chart_.notes.push_back("Cancelled before it was complete.");
    return chart_;
  }

  Status compute_truth() {
    const auto progress = [this](double share) {
      control_.progress({share * share_of_truth, 1.0, "the reference, in double precision"});
    };
    const auto early = [this](const Truth& coarse) -> Status {
      take(coarse);
      if (Status measured = measure_present(); !measured) return measured;
      control_.arrived(chart_);
      return ok();
    };
    Result<Truth> found = truth(scene_,
                                {request_.time.value_or(1.0), 1e-7, share_of_truth * request_.budget,
                                 share_of_stiff_truth * request_.budget, early},
                                control_.stop, progress);
    if (!found) return found.error();
    take(std::move(*found));
    return ok();
  }

  /// Compares with this truth from now on. A point that was compared with a coarse one is measured again.
  void take(Truth found) {
    truth_ = std::move(found);
    chart_.points.clear();
    chart_.left_out.clear();
    times_.clear();
    chart_.size = truth_.size;
    chart_.time = truth_.time;
    chart_.horizon = truth_.horizon;
    chart_.horizon_reason = truth_.horizon_reason;
    chart_.notes = truth_.notes;
    AxisFacts& position = facts(Axis::position);
    if (!truth_.why_no_reference.empty()) {
      const std::string why = "There is no reference: " + truth_.why_no_reference + ".";
      for (const Axis axis : {Axis::position, Axis::energy, Axis::strain}) facts(axis) = {false, why, {}, {}};
      chart_.notes.push_back(why + " Costs and blow-ups can still be charted.");
    } else {
      position = {truth_.horizon > 0.0, truth_.horizon > 0.0 ? "" : truth_.horizon_reason, {}, {}};
      if (position.available) position.reference_error = truth_.position_error / truth_.size;
      facts(Axis::energy) = {true, "", truth_.energy_error, {}};
      facts(Axis::strain) = {true, "", truth_.strain_error, {}};
      if (!position.available)
        chart_.notes.push_back(truth_.horizon_reason +
                               " Energy and the largest strain can still be compared, statistically.");
    }
  }

  /// What only some of the points, or the picture, are compared with.
  Status compute_bounds() {
    if (Status settles = compute_rest(); !settles) return settles;
    return facts(Axis::position).available ? compute_floor() : ok();
  }

  Status compute_rest() {
    Result<Settling> settling = settle(truth_.world, truth_.size, 0.1 * request_.budget, control_.stop);
    if (!settling && was_cancelled(settling.error())) return settling.error();
    if (!settling) {
      facts(Axis::rest) = {false, settling.error().what + "; " + settling.error().remedy, {}, {}};
      return ok();
    }
    settling_ = std::move(*settling);
    facts(Axis::rest) = {true, "", settling_->reference_error, {}};
    return ok();
  }

  /// Of RK4, where that is the reference.
  Status compute_floor() {
    if (truth_.pace.method != reference::Pace::Method::rk4) return ok();
    const double limit = limit_of(Method::rk4, scene_, truth_);
    Result<std::optional<double>> floor =
        float32_floor(scene_, truth_, 0.5 * limit, 0.1 * request_.budget, trials_, control_.stop);
    if (!floor) return floor.error();
    facts(Axis::position).float32_floor = *floor;
    return ok();
  }

  AxisFacts& facts(Axis axis) { return chart_.axes[index(axis)]; }

  /// The wall time that one point may take at most [s].
  double most_a_point() const { return std::max(1.0, share_of_a_point * request_.budget); }
  double until() const { return truth_.time; }
  double horizon() const { return truth_.horizon > 0.0 ? truth_.horizon : truth_.time; }

  /// The ladder whose next point costs least, so that with any budget the curves are complete from their
  /// cheap ends on. Ladders whose next point is not worth it are left out. Null: all ladders are done.
  Ladder* cheapest() {
    Ladder* best = nullptr;
    for (Ladder& ladder : ladders_) {
      if (ladder.done) continue;
      const double least = ladder.price(horizon());
      if (least > most_a_point())
        leave_out(ladder, "a run takes about " + with_significant_digits(least, 3) + " s, more than the " +
                              with_significant_digits(most_a_point(), 3) +
                              " s a point may take of this budget");
      else if (least > left() - (settling_ ? share_of_rest * request_.budget : 0.0))
        leave_out(ladder, "the budget of " + with_significant_digits(request_.budget, 3) + " s is spent");
      else if (dominated(ladder))
        leave_out(ladder, "other iterations of the method reach this error for a twentieth of the cost");
      if (!ladder.done && (!best || least < best->price(horizon()))) best = &ladder;
    }
    return best;
  }

  void leave_out(Ladder& ladder, const std::string& reason) {
    ladder.done = true;
    LeftOut left;
    left.method = ladder.next.method;
    left.dt = ladder.next.dt;
    if (iterates(left.method)) left.iterations = ladder.next.iterations;
    left.reason = reason + "; shorter steps are left out, too";
    chart_.left_out.push_back(left);
  }

  bool dominated(const Ladder& ladder) const {
    if (!std::isfinite(ladder.least_error)) return false;
    const double cost = 1000.0 * ladder.step_cost / ladder.next.dt;
    return std::any_of(chart_.points.begin(), chart_.points.end(), [&](const Point& point) {
      const std::optional<double> error = decisive_error(point.error);
      return point.setting.method == ladder.next.method &&
             point.setting.iterations != ladder.next.iterations && error && point.cost &&
             *error < ladder.least_error / step_ratio && dominated_cost_ratio * point.cost->median < cost;
    });
  }

  /// The error that decides if a shorter step is worth it: of positions, else of energy; none: not known.
  std::optional<double> decisive_error(const Errors& error) const {
    for (const Axis axis : {Axis::position, Axis::energy})
      if (chart_.axes[index(axis)].available) return error[index(axis)];
    return std::nullopt;
  }

  Status climb(Ladder& ladder) {
    Point point;
    point.setting = ladder.next;
    point.setting.dt = fitted_dt(ladder.next.dt, truth_);
    for (const Point& known : chart_.points)
      if (known.setting == point.setting) {  // most likely the scene's own setting
        ladder.go_on(decisive_error(known.error), facts(Axis::position).reference_error);
        return ok();
      }
    control_.progress({std::clamp(elapsed() / request_.budget, ladders_.empty() ? 0.0 : share_of_truth, 0.99),
                       1.0, text(point.setting)});
    const scene::Scene scene = with(scene_, point.setting);
    const double long_enough = ladder.price(until()) <= most_a_point() ? until() : horizon();
    Result<Trial> trial = trials_.run(scene, truth_, long_enough, control_.stop, late * most_a_point());
    if (!trial) return trial.error();
    if (trial->late) {
      leave_out(ladder,
                "a run had not ended after " + with_significant_digits(late * most_a_point(), 3) + " s");
      return ok();
    }
    point.error = trial->error;
    point.largest_position_error = trial->largest_position_error;
    if (trial->convergence.measured > 0) {
      point.residual = trial->convergence.residual;
      point.step_error = trial->convergence.error;
    }
    point.blew_up_at = trial->blew_up_at;
    if (std::isfinite(ladder.limit) && ladder.limit > 0.0)
      point.dt_over_limit = point.setting.dt / ladder.limit;
    std::vector<double> times;
    if (!point.blew_up_at) {
      if (decisive_error(point.error).value_or(0.0) > useless_error) {
        times = {1000.0 * trial->wall / trial->simulated};
      } else {
        Result<std::vector<std::vector<double>>> measured =
            trials_.time({scene}, until(), timed, rounds_at_once, control_.stop);
        if (!measured) return measured.error();
        times = std::move(measured->front());
      }
      point.cost = cost_of(times);
      ladder.step_cost = point.cost->median * point.setting.dt / 1000.0;
    }
    chart_.points.push_back(point);
    times_.push_back(std::move(times));
    ladder.go_on(decisive_error(point.error), facts(Axis::position).reference_error);
    return ok();
  }

  /// Measures the scene's own setting as the first point, if its method is asked for.
  Status measure_present() {
    Ladder present;
    present.next = chart_.present = setting_of(scene_);
    chart_.present.dt = fitted_dt(present.next.dt, truth_);
    const std::vector<Method>& methods = request_.methods;
    if (!methods.empty() && std::find(methods.begin(), methods.end(), present.next.method) == methods.end())
      return ok();
    present.limit = limit_of(present.next.method, scene_, truth_);
    return climb(present);
  }

  /// Measures the errors of Axis::rest, cheapest points first, as far as the budget allows. Each takes a run
  /// of its own, which is longer, so that points which blew up or whose error is useless are skipped.
  Status settle_points() {
    if (!settling_) return ok();
    std::vector<Point*> points;
    for (Point& point : chart_.points)
      if (point.cost && decisive_error(point.error).value_or(0.0) <= useless_error) points.push_back(&point);
    std::sort(points.begin(), points.end(),
              [](const Point* a, const Point* b) { return a->cost->median < b->cost->median; });
    std::size_t without = 0;
    for (Point* point : points) {
      const double price = point->cost->median / 1000.0 * settling_->time;
      if (price > most_a_point() || price > left()) {
        ++without;
        continue;
      }
      control_.progress({0.95, 1.0, "coming to rest: " + text(point->setting)});
      Result<std::optional<double>> error =
          rest_error(*settling_, with(settling_->scene, point->setting), truth_.size, trials_, control_.stop);
      if (!error) return error.error();
      point->error[index(Axis::rest)] = *error;
      control_.arrived(chart_);
    }
    if (without > 0)
      chart_.notes.push_back("The error of the shape of rest is not known for " + std::to_string(without) +
                             " points: " + with_significant_digits(settling_->time, 3) +
                             " s until they rest take too long for this budget.");
    return ok();
  }

  /// Times all points again, in turns, so that a slow minute of the machine affects all points alike.
  Status time_again() {
    for (int round = 0; round < rounds_later; ++round)
      for (std::size_t i = 0; i < chart_.points.size(); ++i) {
        if (times_[i].empty() || left() < 0.0) continue;
        control_.progress({0.99, 1.0, "timing once more, taking turns"});
        Result<std::vector<std::vector<double>>> measured =
            trials_.time({with(scene_, chart_.points[i].setting)}, until(), timed, 1, control_.stop);
        if (!measured) return measured.error();
        times_[i].push_back(measured->front().front());
        chart_.points[i].cost = cost_of(times_[i]);
      }
    return ok();
  }

  const scene::Scene& scene_;
  const ChartRequest& request_;
  const Control<Chart>& control_;
  Clock::time_point start_;
  Chart chart_;
  Truth truth_;
  std::optional<Settling> settling_;
  TrialRunner trials_;
  std::vector<Ladder> ladders_;
  std::vector<std::vector<double>> times_;  ///< [point][timing] [ms per simulated second]
};

}  // namespace

Result<Chart> chart(const scene::Scene& scene, const ChartRequest& request, const Control<Chart>& control) {
  const Result<std::vector<Method>> methods = scene::suited_methods(scene, request.methods);
  if (!methods) return methods.error();
  ChartRequest suited = request;
  suited.methods = *methods;
  return ChartMeasurement(scene, suited, control).run();
}

std::optional<Axis> first_with_errors(const Chart& chart) {
  for (const Axis axis : all_axes)
    if (chart.axes[index(axis)].available) return axis;
  return std::nullopt;
}

}  // namespace clothlab::lab
