#include "server/lab/measure/truth.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "server/base/text.h"
#include "server/base/thread_clock.h"
#include "server/lab/measure/control.h"
#include "server/lab/measure/first_touch.h"
#include "server/lab/measure/horizon.h"
#include "server/lab/measure/sizes.h"
#include "server/model/extent.h"
#include "server/reference/follower.h"
#include "server/reference/trajectory.h"
#include "server/sim/colliders.h"

namespace clothlab::lab {

namespace {

using reference::Follower;
using reference::Pace;
using reference::State;
using reference::World;

/// The reference's longest step in units of 1 / fastest_rate. RK4 is stable up to 2.6; at 1 its error on the
/// swinging cloth is already as small as float32 allows at best, 1e-7 of the size.
constexpr double longest_phase_step = 1.0;
constexpr int fewest_steps = 64;  // with fewer affordable steps there is no reference
constexpr int most_halvings = 8;  // of the step

// Of a stiff reference.
/// Estimated error a second of its longest steps [sizes/s]: they are as long as the motion allows, and halved
/// from there on.
constexpr double stiff_error_rate = 3e-3;
/// Its equations are solved to this [sizes]: far below the perturbation that finds the horizon.
constexpr double stiff_precision = 1e-11;
constexpr double stiff_first_step = 1e-3;  // [s]
/// The error that it aims for, in units of RK4's: each further tenth costs it two to four times the time.
constexpr double stiff_accuracy = 100.0;
constexpr double share_of_scouting = 0.4;     // of the budget: two of five runs like the first one
constexpr double share_of_first_look = 0.05;  // of that
constexpr int fewest_stiff_looks = 3;         // with a shorter affordable time there is no reference
constexpr int fewest_looks_to_touch = 4;      // with surfaces that touch earlier there is no reference

double seconds_since(ThreadClock::time_point start) {
  return std::chrono::duration<double>(ThreadClock::now() - start).count();
}

/// The samples of one run of the reference.
struct Run {
  std::vector<std::vector<glm::dvec3>> position;    ///< [sample up to the horizon][vertex] [m]
  std::vector<double> energy, kinetic_and_elastic;  ///< [sample] [J]; `energy`: the total
  std::vector<double> strain;                       ///< [sample] |l/L - 1|
};

bool finite(const State& state) {
  return std::all_of(state.position.begin(), state.position.end(),
                     [](const glm::dvec3& x) { return std::isfinite(x.x + x.y + x.z); });
}

class Search {
 public:
  Search(Truth& truth, const TruthRequest& request, FirstTouch& touch, const std::stop_token& stop,
         const std::function<void(double)>& progress)
      : truth_(truth),
        request_(request),
        touch_(touch),
        stop_(stop),
        progress_(progress),
        start_(ThreadClock::now()),
        budget_(request.budget),
        accuracy_(request.accuracy) {}

  Status run() {
    if (reference::cheaper_method(truth_.world) == Pace::Method::esdirk) {
      budget_ = request_.stiff_budget.value_or(request_.budget);
      accuracy_ = stiff_accuracy * request_.accuracy;
      if (Status found = scout(); !found || !truth_.why_no_reference.empty()) return found;
      return refine();
    }
    pace_.largest_step = longest_phase_step / reference::fastest_rate(truth_.world);
    if (Status fits = fit_time(); !fits || !truth_.why_no_reference.empty()) return fits;
    if (Status found = find_horizon(); !found || !truth_.why_no_reference.empty()) return found;
    return refine();
  }

 private:
  ThreadClock::time_point after(double seconds) const {
    return start_ + std::chrono::duration_cast<ThreadClock::duration>(std::chrono::duration<double>(seconds));
  }
  double left() const { return budget_ - seconds_since(start_); }

  /// Sets the time that the reference can afford to simulate, or the reason why there is no reference. The
  /// work is that of five runs with the longest step: two for the motion and its perturbed copy, one to
  /// record the samples, and two for the run with half the step.
  Status fit_time() {
    const double step = pace_.largest_step;
    Follower follower(truth_.world, pace_, stop_);
    State state = reference::at_rest(truth_.world);
    const ThreadClock::time_point begun = ThreadClock::now();
    int tried = 0;
    for (; tried < 8 || (tried < 256 && seconds_since(begun) < 0.1); ++tried)
      if (!follower.follow(state, tried * step, (tried + 1) * step)) return cancelled;
    const double cost = seconds_since(begun) / tried;
    const double affordable = 0.6 * budget_ / (5.0 * cost) * step;
    truth_.time = std::min(request_.time, affordable);
    if (truth_.time == request_.time) return ok();
    end_earlier(1.0 / step, cost, truth_.time < fewest_steps * step || truth_.time < 0.02 * request_.time);
    return ok();
  }

  /// Tells that the budget ends the reference at `truth_.time`, or that it is not enough for any. `rate`
  /// [1/s], `cost` [s]: of steps.
  void end_earlier(double rate, double cost, bool too_early) {
    const std::string work = "a second of the reference takes " + with_significant_digits(rate, 3) +
                             " steps of " + with_significant_digits(1000.0 * cost, 3) + " ms";
    if (too_early)
      truth_.why_no_reference =
          work + ", more than fits into " + with_significant_digits(budget_, 3) +
          " s; softer or heavier springs, a coarser mesh or a shorter time would bring it back";
    else
      ended_ = "The reference ends at " + with_significant_digits(truth_.time, 3) + " s: " + work +
               ", and five runs of it have to fit into a budget of " + with_significant_digits(budget_, 3) +
               " s. ";
  }

  /// Ends the reference at time `before` [s] if surfaces touch in `state`, at time `now` [s], or tells that
  /// there is none. `look`: how many have gone before.
  bool ended_by_touch(const State& state, double before, double now, int look) {
    if (request_.beyond_touch) return false;
    const std::string touching = touch_.look(state.position, now);
    if (touching.empty()) return false;
    const std::string when = touching + " touch before " + with_significant_digits(now, 3) + " s";
    truth_.time = before;
    if (look < fewest_looks_to_touch)
      truth_.why_no_reference = when + ", and the reference knows no contact between surfaces";
    else
      ended_ = "The reference ends at " + with_significant_digits(before, 3) + " s: " + when +
               ", and it knows no contact between surfaces. ";
    return true;
  }

  void not_finite_after(double time) {
    truth_.why_no_reference = "the reference's own motion is not finite after " +
                              with_significant_digits(time, 3) +
                              " s; softer or heavier springs, or a shorter time, would bring it back";
  }

  /// Follows the motion and a perturbed copy until they are too far apart.
  Status find_horizon() {
    Follower follower(truth_.world, pace_, stop_);
    State state = reference::at_rest(truth_.world);
    Horizon horizon(truth_.world, truth_.size);
    const double whole = truth_.time;
    bool near = true;
    for (int look = 1; look <= looks_for_horizon; ++look) {
      const double from = whole * (look - 1) / looks_for_horizon, to = whole * look / looks_for_horizon;
      if (!follower.follow(state, from, to) || (near && !follower.follow(horizon.copy(), from, to)))
        return cancelled;
      if (!finite(state)) {
        not_finite_after(to);
        return ok();
      }
      progress_(0.3 * look / looks_for_horizon);
      if (ended_by_touch(state, from, to, look - 1)) break;
      near = near && horizon.look(state, to);
    }
    set_horizon(horizon);
    return ok();
  }

  void set_horizon(const Horizon& horizon) {
    truth_.horizon = horizon.time(truth_.time);
    truth_.horizon_reason = ended_ + horizon.reason(truth_.time);
  }

  /// Of a stiff scene, all three at once: the pace, the time that the reference can afford, and the horizon.
  Status scout() {
    reference::Scout scout(truth_.world, stiff_error_rate * truth_.size, stiff_precision * truth_.size,
                           stiff_first_step, stop_);
    Follower beside(truth_.world, scout.pace(), stop_);
    State state = reference::at_rest(truth_.world);
    Horizon horizon(truth_.world, truth_.size);
    bool near = true;
    truth_.time = request_.time;
    for (int look = 1; look <= looks_for_horizon; ++look) {
      const double from = request_.time * (look - 1) / looks_for_horizon,
                   to = request_.time * look / looks_for_horizon;
      // What does not get through the first of the looks in this time will not through the others.
      const double share = share_of_scouting * (look == 1 ? share_of_first_look : 1.0);
      if (!scout.follow(state, from, to, after(share * budget_))) {
        if (!scout.late()) return cancelled;
        truth_.time = from;
        const auto steps = static_cast<double>(std::max<std::uint64_t>(scout.work().steps, 1));
        end_earlier(steps / std::max(from, scout.pace().largest_step), seconds_since(start_) / (2.0 * steps),
                    look <= fewest_stiff_looks);
        if (!truth_.why_no_reference.empty()) return ok();
        break;
      }
      beside.set_pace(scout.pace());
      if (near && !beside.follow(horizon.copy(), from, to)) return cancelled;
      if (!finite(state)) {
        not_finite_after(to);
        return ok();
      }
      if (ended_by_touch(state, from, to, look - 1)) break;
      near = near && horizon.look(state, to);
      progress_(0.3 * look / looks_for_horizon);
    }
    if (!truth_.why_no_reference.empty()) return ok();
    set_horizon(horizon);
    pace_ = scout.pace();
    truth_.notes.push_back("The scene is too stiff for RK4, which would take " +
                           with_significant_digits(reference::fastest_rate(truth_.world), 3) +
                           " steps a second: the reference is an implicit method of third order.");
    return ok();
  }

  /// Runs the reference at a pace and records its samples; the job's progress goes from `share_from` to
  /// `share_to`.
  Result<Run> record(const Pace& pace, double share_from, double share_to) {
    Follower follower(truth_.world, pace, stop_);
    State state = reference::at_rest(truth_.world);
    Run run;
    const int count = static_cast<int>(std::floor(truth_.time / truth_.spacing + 1e-9));
    for (int k = 1; k <= count; ++k) {
      if (!follower.follow(state, (k - 1) * truth_.spacing, k * truth_.spacing)) return cancelled;
      if (truth_.horizon > 0.0 && k <= samples_to_horizon) run.position.push_back(state.position);
      const reference::Energy energy = energy_of_free(truth_.world, state);
      run.energy.push_back(energy.total());
      run.kinetic_and_elastic.push_back(energy.kinetic + energy.elastic);
      run.strain.push_back(largest_strain(truth_.world, state));
      progress_(share_from + (share_to - share_from) * k / count);
    }
    return run;
  }

  /// Halves the step until the reference is accurate enough, or no longer improves, or the next run would not
  /// fit into the budget.
  Status refine() {
    truth_.spacing = (truth_.horizon > 0.0 ? truth_.horizon : truth_.time) / samples_to_horizon;
    ThreadClock::time_point begun = ThreadClock::now();
    Result<Run> coarse = record(pace_, 0.3, 0.4);
    if (!coarse) return coarse.error();
    double difference_before = 0.0;
    for (int halving = 1; halving <= most_halvings; ++halving) {
      const double spent = seconds_since(begun);
      if (halving > 1 && 2.2 * spent > left()) break;
      begun = ThreadClock::now();
      Result<Run> fine = record(pace_.halved(halving), 0.4 + 0.6 * (1.0 - 1.0 / halving), 1.0);
      if (!fine) return fine.error();
      truth_.pace = pace_.halved(halving);
      const double difference = compare(*coarse, *fine, difference_before);
      coarse = std::move(fine);
      if (truth_.horizon == 0.0 && halving > 1) break;
      if (truth_.position_error <= accuracy_ * truth_.size) break;
      if (halving > 2 && difference > 0.7 * difference_before) break;  // no better: chaos or contacts
      difference_before = difference;
      if (halving > 1 || !request_.early) continue;
      take(*coarse);
      const ThreadClock::time_point told = ThreadClock::now();
      if (Status taken = request_.early(truth_); !taken) return taken;
      budget_ += seconds_since(told);
      begun += ThreadClock::now() - told;
    }
    take(std::move(*coarse));
    return ok();
  }

  void take(Run run) {
    truth_.position = std::move(run.position);
    truth_.energy = std::move(run.energy);
    truth_.strain = std::move(run.strain);
  }

  /// Returns the difference of two runs at the horizon, RMS [m] (without a horizon 0), and estimates the
  /// errors of the finer one. For positions that is Richardson's estimate with the order that `before`, the
  /// last difference, shows, at most the method's own order; at first it is the difference itself.
  double compare(const Run& coarse, const Run& fine, double before) {
    const double difference =
        truth_.horizon > 0.0 ? reference::rms_distance(coarse.position.back(), fine.position.back()) : 0.0;
    const double most = pace_.method == Pace::Method::rk4 ? 16.0 : 8.0;
    const double ratio = before > 0.0 && difference > 0.0 ? std::clamp(before / difference, 1.0, most) : 2.0;
    truth_.position_error = difference / std::max(ratio - 1.0, 1.0);
    truth_.energy_scale = *std::max_element(fine.kinetic_and_elastic.begin(), fine.kinetic_and_elastic.end());
    double sum = 0.0;
    for (std::size_t k = 0; k < fine.energy.size(); ++k)
      sum += (fine.energy[k] - coarse.energy[k]) * (fine.energy[k] - coarse.energy[k]);
    truth_.energy_error = std::sqrt(sum / static_cast<double>(fine.energy.size())) / truth_.energy_scale;
    const double peak = *std::max_element(fine.strain.begin(), fine.strain.end());
    truth_.strain_error =
        std::abs(*std::max_element(coarse.strain.begin(), coarse.strain.end()) - peak) / peak;
    return difference;
  }

  Truth& truth_;
  const TruthRequest& request_;
  FirstTouch& touch_;
  const std::stop_token& stop_;
  const std::function<void(double)>& progress_;
  ThreadClock::time_point start_;
  double budget_, accuracy_;
  std::string ended_;  // why the reference ends before the time that was asked for, a sentence and a space
  Pace pace_;          // with the longest steps
};

}  // namespace

Result<Truth> truth(const scene::Scene& scene, const TruthRequest& request, const std::stop_token& stop,
                    const std::function<void(double share)>& progress) {
  Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  Result<World> world = reference::make_world(scene, sim::contact_margins(scene, *model));
  if (!world) return world.error();
  Truth truth;
  truth.world = std::move(*world);
  truth.size = model::largest_extent(truth.world.model);
  truth.asked = request.time;
  FirstTouch touch(scene, truth.world.model);
  if (Status found = Search(truth, request, touch, stop, progress).run(); !found) return found.error();
  if (truth.horizon > 0.0 && truth.horizon < truth.asked)
    truth.horizon_reason = "Judged up to " + with_significant_digits(truth.horizon, 3) + " s of the " +
                           with_significant_digits(truth.asked, 3) + " s asked for. " + truth.horizon_reason;
  if (!truth.why_no_reference.empty()) {  // steps and costs can be measured without it
    truth.time = request.time;
    truth.horizon = 0.0;
    truth.spacing = truth.time / samples_to_horizon;
  }
  return truth;
}

}  // namespace clothlab::lab
