#include "server/lab/measure/truth.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <random>

#include "server/base/text.h"
#include "server/lab/measure/control.h"
#include "server/lab/measure/follower.h"
#include "server/model/extent.h"
#include "server/reference/trajectory.h"
#include "server/sim/colliders.h"

namespace clothlab::lab {

namespace {

using reference::State;
using reference::World;
using Clock = std::chrono::steady_clock;

/// The reference's longest step in units of 1 / fastest_rate. RK4 is stable up to 2.6; at 1 its error on the
/// swinging cloth is already as small as float32 allows at best, 1e-7 of the size.
constexpr double longest_phase_step = 1.0;
constexpr int looks = 128;             // comparisons with a perturbed copy, over the whole time
constexpr double perturbation = 1e-7;  // of the copy's start, RMS over the size
/// The horizon is where the perturbation has grown by this factor. There chaos alone turns an error of 1e-4
/// into one of 1e-2.
constexpr double growth_by_chaos = 100.0;
constexpr int fewest_steps = 64;  // with fewer affordable steps there is no reference
constexpr int most_halvings = 8;  // of the step

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double largest_strain(const World& world, const State& state) {
  double most = 0.0;
  model::each_element(world.model.elements, [&](const auto& element) {
    most = std::max(most, element_strain(element.law, edges(element, 0, state.position)));
  });
  return most;
}

/// The energy without the kinetic and gravitational energy of pinned vertices, as the GPU's diagnostics count
/// it.
reference::Energy energy_of_free(const World& world, const State& state) {
  reference::Energy sum = reference::energy(world, state);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (!world.pinned(i)) continue;
    const double mass = world.model.mass[i];
    sum.kinetic -= 0.5 * mass * glm::dot(state.velocity[i], state.velocity[i]);
    sum.gravitational += mass * glm::dot(world.scene.gravity, state.position[i]);
  }
  return sum;
}

/// The samples of one run of the reference.
struct Run {
  std::vector<std::vector<glm::dvec3>> position;    ///< [sample up to the horizon][vertex] [m]
  std::vector<double> energy, kinetic_and_elastic;  ///< [sample] [J]; `energy`: the total
  std::vector<double> strain;                       ///< [sample] |l/L - 1|
};

/// The start with every free vertex moved a little in a random direction, the same in every run.
State perturbed_start(const World& world, double size) {
  State state = reference::at_rest(world);
  std::mt19937 random(1);
  const auto next = [&] { return 2.0 * static_cast<double>(random()) / 4294967296.0 - 1.0; };
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const glm::dvec3 push(next(), next(), next());
    if (!world.pinned(i)) state.position[i] += perturbation * size * push;  // RMS length of `push`: 1
  }
  return state;
}

bool finite(const State& state) {
  return std::all_of(state.position.begin(), state.position.end(),
                     [](const glm::dvec3& x) { return std::isfinite(x.x + x.y + x.z); });
}

class Search {
 public:
  Search(Truth& truth, const TruthRequest& request, const std::stop_token& stop,
         const std::function<void(double)>& progress)
      : truth_(truth), request_(request), stop_(stop), progress_(progress), start_(Clock::now()) {}

  Status run() {
    step_ = longest_phase_step / reference::fastest_rate(truth_.world);
    if (Status fits = fit_time(); !fits || !truth_.why_no_reference.empty()) return fits;
    if (Status found = find_horizon(); !found || !truth_.why_no_reference.empty()) return found;
    return refine();
  }

 private:
  double left() const { return request_.budget - seconds_since(start_); }

  /// Sets the time that the reference can afford to simulate, or the reason why there is no reference. The
  /// work is that of five runs with the longest step: two for the motion and its perturbed copy, one to
  /// record the samples, and two for the run with half the step.
  Status fit_time() {
    Follower follower(truth_.world, step_, stop_);
    State state = reference::at_rest(truth_.world);
    const Clock::time_point begun = Clock::now();
    int tried = 0;
    for (; tried < 8 || (tried < 256 && seconds_since(begun) < 0.1); ++tried)
      if (!follower.follow(state, tried * step_, (tried + 1) * step_)) return cancelled;
    const double cost = seconds_since(begun) / tried;
    const double affordable = 0.6 * request_.budget / (5.0 * cost) * step_;
    truth_.time = std::min(request_.time, affordable);
    if (truth_.time == request_.time) return ok();
    const std::string work = "a second of the reference takes " + with_significant_digits(1.0 / step_, 3) +
                             " steps of " + with_significant_digits(1000.0 * cost, 3) + " ms";
    if (truth_.time < fewest_steps * step_ || truth_.time < 0.02 * request_.time)
      truth_.why_no_reference =
          work + ", more than fits into " + with_significant_digits(request_.budget, 3) +
          " s; softer or heavier springs, a coarser mesh or a shorter time would bring it back";
    else
      truth_.notes.push_back("The reference ends at " + with_significant_digits(truth_.time, 3) +
                             " s: " + work + ".");
    return ok();
  }

  /// Follows the motion and a perturbed copy until they are too far apart.
  Status find_horizon() {
    Follower follower(truth_.world, step_, stop_);
    State state = reference::at_rest(truth_.world), copy = perturbed_start(truth_.world, truth_.size);
    const double begun = reference::rms_distance(state.position, copy.position);
    double most = 1.0;
    for (int look = 1; look <= looks; ++look) {
      const double from = truth_.time * (look - 1) / looks, to = truth_.time * look / looks;
      if (!follower.follow(state, from, to) || !follower.follow(copy, from, to)) return cancelled;
      if (!finite(state)) {
        truth_.why_no_reference =
            "the reference's own motion is not finite after " + with_significant_digits(to, 3) + " s";
        return ok();
      }
      most = std::max(most, reference::rms_distance(state.position, copy.position) / begun);
      progress_(0.3 * look / looks);
      if (most > growth_by_chaos) break;
      truth_.horizon = to;
      amplified_ = most;
    }
    explain_horizon(most);
    return ok();
  }

  void explain_horizon(double most) {
    const std::string copy =
        "a copy that starts " + with_significant_digits(perturbation, 3) + " of the size away";
    if (truth_.horizon < 4.0 * truth_.time / looks) {
      truth_.horizon = 0.0;
      truth_.horizon_reason = "The motion is chaotic at once: " + copy + " is more than " +
                              with_significant_digits(growth_by_chaos, 3) + " times as far away after " +
                              with_significant_digits(4.0 * truth_.time / looks, 3) + " s.";
    } else if (truth_.horizon < truth_.time) {
      truth_.horizon_reason = "Positions are compared at " + with_significant_digits(truth_.horizon, 3) +
                              " s: " + copy + " is up to " + with_significant_digits(amplified_, 3) +
                              " times as far away until then, and over " +
                              with_significant_digits(growth_by_chaos, 3) + " times soon after.";
    } else {
      truth_.horizon_reason =
          "Positions are compared at " + with_significant_digits(truth_.horizon, 3) +
          " s, the whole time: " + copy +
          (most < 1.5 ? " stays as near."
                      : " comes no more than " + with_significant_digits(most, 3) + " times as far away.");
    }
  }

  /// Runs the reference with steps of at most `largest_step` [s] and records its samples; the job's progress
  /// goes from `share_from` to `share_to`.
  Result<Run> record(double largest_step, double share_from, double share_to) {
    Follower follower(truth_.world, largest_step, stop_);
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
    Clock::time_point begun = Clock::now();
    Result<Run> coarse = record(step_, 0.3, 0.4);
    if (!coarse) return coarse.error();
    double difference_before = 0.0;
    for (int halving = 1; halving <= most_halvings; ++halving) {
      const double spent = seconds_since(begun);
      if (halving > 1 && 2.2 * spent > left()) break;
      begun = Clock::now();
      Result<Run> fine = record(step_ / std::exp2(halving), 0.4 + 0.6 * (1.0 - 1.0 / halving), 1.0);
      if (!fine) return fine.error();
      truth_.dt = step_ / std::exp2(halving);
      const double difference = compare(*coarse, *fine, difference_before);
      coarse = std::move(fine);
      if (truth_.horizon == 0.0 && halving > 1) break;
      if (truth_.position_error <= request_.accuracy * truth_.size) break;
      if (halving > 2 && difference > 0.7 * difference_before) break;  // no better: chaos or contacts
      difference_before = difference;
    }
    truth_.position = std::move(coarse->position);
    truth_.energy = std::move(coarse->energy);
    truth_.strain = std::move(coarse->strain);
    return ok();
  }

  /// Returns the difference of two runs at the horizon, RMS [m] (without a horizon 0), and estimates the
  /// errors of the finer one. For positions that is Richardson's estimate with the order that `before`, the
  /// last difference, shows, at most RK4's own order; at first it is the difference itself.
  double compare(const Run& coarse, const Run& fine, double before) {
    const double difference =
        truth_.horizon > 0.0 ? reference::rms_distance(coarse.position.back(), fine.position.back()) : 0.0;
    const double ratio = before > 0.0 && difference > 0.0 ? std::clamp(before / difference, 1.0, 16.0) : 2.0;
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
  const std::stop_token& stop_;
  const std::function<void(double)>& progress_;
  Clock::time_point start_;
  double step_ = 0, amplified_ = 1;
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
  if (Status found = Search(truth, request, stop, progress).run(); !found) return found.error();
  if (!truth.why_no_reference.empty()) {  // steps and costs can be measured without it
    truth.time = request.time;
    truth.horizon = 0.0;
    truth.spacing = truth.time / samples_to_horizon;
  }
  return truth;
}

}  // namespace clothlab::lab
