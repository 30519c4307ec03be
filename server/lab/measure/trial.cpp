#include "server/lab/measure/trial.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "server/base/text.h"
#include "server/lab/measure/spread.h"
#include "server/lab/measure/stepping.h"
#include "server/model/stability.h"
#include "server/reference/trajectory.h"
#include "server/sim/guarded_run.h"
#include "server/sim/plan.h"

namespace clothlab::lab {

namespace {

constexpr int fewest_samples = 4;       // samples of the truth that a run meets at least
constexpr double most_rounding = 0.04;  // largest share of steps added in order to meet more samples
constexpr double same_step = 1e-5;      // relative error of a step that was rounded to six digits

/// Accumulates a run's errors, sample by sample.
class ErrorsSoFar {
 public:
  explicit ErrorsSoFar(const Truth& truth) : truth_(truth) {}

  /// Compares the run's present state with the truth's sample `k`, counted from 1, and updates `trial`'s
  /// errors.
  void add(int k, sim::Simulation& simulation, const sim::Diagnostics& state, Trial& trial) {
    const auto sample = static_cast<std::size_t>(k - 1);
    if (sample >= truth_.energy.size()) return;
    const double off = state.total_energy() - truth_.energy[sample];
    squares_ += off * off;
    ++count_;
    strain_ = std::max(strain_, state.max_strain);
    true_strain_ = std::max(true_strain_, truth_.strain[sample]);
    trial.error[index(Axis::energy)] = std::sqrt(squares_ / count_) / truth_.energy_scale;
    trial.error[index(Axis::strain)] = std::abs(strain_ - true_strain_) / true_strain_;
    if (sample >= truth_.position.size()) return;
    const sim::State read = simulation.read_state();
    const double error =
        reference::rms_distance({read.position.begin(), read.position.end()}, truth_.position[sample]) /
        truth_.size;
    trial.largest_position_error = std::max(trial.largest_position_error.value_or(0.0), error);
    if (k != samples_to_horizon) return;
    trial.error[index(Axis::position)] = error;
    trial.at_horizon = read.position;
  }

 private:
  const Truth& truth_;
  double squares_ = 0, strain_ = 0, true_strain_ = 0;
  int count_ = 0;
};

Trial without_errors(Trial trial) {
  trial.error = {};
  trial.largest_position_error.reset();
  return trial;
}

}  // namespace

int steps_to_horizon(double dt, const Truth& truth) {
  const double whole = truth.spacing * samples_to_horizon / dt;
  const double fewest = std::max(1.0, std::ceil(whole * (1.0 - same_step)));
  // `multiple` is the largest power of two up to 4 % of the steps, at least 4 and at most 64. It doubles at
  // 200, 400, ... steps, which are multiples of the old and the new value: rounding twice is the same as
  // once.
  int multiple = fewest_samples;
  while (multiple < samples_to_horizon && 2 * multiple <= most_rounding * fewest) multiple *= 2;
  return static_cast<int>(std::ceil(fewest / multiple)) * multiple;
}

double fitted_dt(double dt, const Truth& truth) {
  const double fitted = truth.spacing * samples_to_horizon / steps_to_horizon(dt, truth);
  return std::strtod(with_significant_digits(fitted, 6).c_str(), nullptr);
}

Result<sim::Simulation*> TrialRunner::prepare(const scene::Scene& scene) {
  std::unique_ptr<sim::Simulation>& simulation =
      simulations_[{scene.solver.method, sim::plan(scene).most_sweeps}];
  if (!simulation) {
    Result<std::unique_ptr<sim::Simulation>> made = sim::Simulation::create(scene);
    if (!made) return made.error();
    simulation = std::move(*made);
  } else if (Result<sim::ChangeDepth> changed = simulation->change(scene); !changed) {
    return changed.error();
  }
  // Drivers compile a kernel when it first runs, and caches are cold after another scene.
  simulation->measure_convergence(false);
  simulation->step(3);
  simulation->finish();
  simulation->reset();
  return simulation.get();
}

Result<Trial> TrialRunner::run(scene::Scene scene, const Truth& truth, double until,
                               const std::stop_token& stop, double most_wall) {
  const int steps = steps_to_horizon(scene.solver.dt, truth);
  scene.solver.dt = truth.spacing * samples_to_horizon / steps;
  const Result<sim::Simulation*> prepared = prepare(scene);
  if (!prepared) return prepared.error();
  sim::Simulation& simulation = **prepared;
  sim::GuardedRun guard(simulation);
  guard.start(model::dt_limit_if_near(simulation.model(), scene));

  const int common = std::gcd(steps, samples_to_horizon);
  const auto steps_a_sample = static_cast<std::uint64_t>(steps / common);
  const int samples_apart = samples_to_horizon / common;
  const auto last = static_cast<std::uint64_t>(std::ceil(until / scene.solver.dt - 1e-6));
  if (measures_convergence_ && last > 0) simulation.measure_step(last - 1);
  Trial trial;
  ErrorsSoFar errors(truth);
  Stepping stepping(simulation);
  for (std::uint64_t step = 0; step < last;) {
    if (stop.stop_requested()) return cancelled;
    const std::uint64_t next = std::min((step / steps_a_sample + 1) * steps_a_sample, last);
    step += stepping.step(next - step);
    trial.wall = stepping.wall();
    trial.simulated = static_cast<double>(step) * scene.solver.dt;
    if (guard.judge_now() == sim::GuardedRun::Verdict::blown_up) {
      trial.blew_up_at = trial.simulated;
      return without_errors(std::move(trial));
    }
    if (step < last && trial.wall > most_wall) {
      trial.late = true;
      return without_errors(std::move(trial));
    }
    if (step % steps_a_sample == 0)
      errors.add(static_cast<int>(step / steps_a_sample) * samples_apart, simulation, guard.state(), trial);
  }
  trial.convergence = simulation.convergence();
  return trial;
}

Result<std::optional<sim::State>> TrialRunner::run_to(const scene::Scene& scene, double time,
                                                      const std::stop_token& stop) {
  const Result<sim::Simulation*> prepared = prepare(scene);
  if (!prepared) return prepared.error();
  sim::Simulation& simulation = **prepared;
  sim::GuardedRun guard(simulation);
  guard.start(model::dt_limit_if_near(simulation.model(), scene));
  Stepping stepping(simulation);
  const auto steps = static_cast<std::uint64_t>(std::max(1.0, std::round(time / scene.solver.dt)));
  for (std::uint64_t done = 0; done < steps;) {
    if (stop.stop_requested()) return cancelled;
    done += stepping.step(steps - done);
    if (guard.judge_now() == sim::GuardedRun::Verdict::blown_up) return std::optional<sim::State>();
  }
  return std::optional<sim::State>(simulation.read_state());
}

Result<std::vector<std::vector<double>>> TrialRunner::time(const std::vector<scene::Scene>& scenes,
                                                           double simulated, double most, int rounds,
                                                           const std::stop_token& stop) {
  std::vector<std::vector<double>> samples(scenes.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t turn = 0; turn < scenes.size(); ++turn) {
      // Every other round goes backwards, so that a machine that becomes slower favours no scene.
      const std::size_t i = round % 2 ? scenes.size() - 1 - turn : turn;
      const Result<sim::Simulation*> prepared = prepare(scenes[i]);
      if (!prepared) return prepared.error();
      const double dt = scenes[i].solver.dt;
      const auto steps = static_cast<std::uint64_t>(std::max(1.0, std::round(simulated / dt)));
      Stepping stepping(**prepared);
      std::uint64_t done = 0;
      while (done < steps && stepping.wall() < most) {
        if (stop.stop_requested()) return cancelled;
        done += stepping.step(steps - done);
      }
      samples[i].push_back(1000.0 * stepping.wall() / (static_cast<double>(done) * dt));
    }
  }
  return samples;
}

Cost cost_of(const std::vector<double>& times) {
  const Spread spread = spread_of(times, 0.01);
  return {spread.median, *std::min_element(times.begin(), times.end()), static_cast<int>(times.size()),
          spread.low, spread.high};
}

}  // namespace clothlab::lab
