#include "server/lab/measure/map_column.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/lab/measure/disagreement.h"
#include "server/lab/measure/mode_growth.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"

namespace clothlab::lab {

namespace {

using scene::Method;

constexpr int rows = 8;             // number of first trials around the limit ...
constexpr double farthest = 1.7;    // ... at steps up to this factor shorter or longer
constexpr double precision = 1.01;  // the search ends at this ratio of the failed to the held step
constexpr int trials_expected = rows + 5;
/// Steps that a method without a step limit is tried at; each has to hold [s].
constexpr std::array long_steps{1.0 / 30, 1.0 / 10};
constexpr int long_steps_run = 20;

/// The number of steps of a trial at the limit: so many that growth shows at a step 2 % beyond the limit, by
/// the growth rates of mode_growth.h. With a step beyond the limit by a share x, a vibration grows by exp(g)
/// a step. Under symplectic Euler and Verlet, without damping, 2 cosh(g) = 2 + 8 x: g = sqrt(8 x) = 0.4 at
/// 2 %. With damping, the root leaves -1 along the real axis: g = 2 x (4 - d) / d for d = damping dt. Under
/// RK4, g = 7.1 x. In fewer steps than `fewest` a cloth would not leave its start. `most_vertex_steps` bounds
/// the work of large meshes, `most` that of explicit Euler, whose g = d x / 2 may ask for a million steps.
int steps_at_limit(Method method, const model::Mode& mode, double limit, std::size_t vertices) {
  constexpr double fewest = 240, most = 600, most_vertex_steps = 3e6;
  const double affordable = std::clamp(most_vertex_steps / static_cast<double>(vertices), 200.0, most);
  const double needed = e_folds_to_show / growth_a_step(method, mode, 1.02 * limit);
  return static_cast<int>(std::min(affordable, std::max(fewest, needed)));
}

class Column {
 public:
  Column(const scene::Scene& scene, ReusedSimulation& full, ReusedSimulation& bare,
         const std::stop_token& stop, const AtTrial& at_trial)
      : scene_(scene), full_(full), bare_(bare), stop_(stop), at_trial_(at_trial) {}

  Result<MeasuredColumn> measure(double value) {
    const Result<sim::Simulation*> simulation = full_.prepare(scene_);
    if (!simulation) return simulation.error();
    measured_.column.value = value;
    const Status found = find_theory((*simulation)->model());
    if (!found) return found.error();
    if (const Status done = theory_ ? try_around_limit() : try_long_steps(); !done) return done.error();
    conclude();
    if (const Status explained = explain(); !explained) return explained.error();
    return std::move(measured_);
  }

 private:
  Status find_theory(const model::Model& model) {
    const Method method = scene_.solver.method;
    const std::vector<model::ElementOperator> extremes = model::extreme_operators(model, scene_);
    double limit = model::no_limit;
    const model::ElementOperator* decisive = nullptr;
    for (const model::ElementOperator& elements : extremes)
      if (const double own = model::dt_limit(method, elements, stop_); !decisive || own < limit) {
        limit = own;
        decisive = &elements;
      }
    if (stop_.stop_requested()) return cancelled;
    if (limit == model::no_limit) return ok();
    theory_ = measured_.column.theory = limit;
    mode_ = fastest_growing(method, *decisive, stop_);
    most_steps_ = steps_at_limit(method, mode_, limit, model.vertex_count());
    shortest_visible_dt_ = shortest_visible(method, mode_, most_steps_, e_folds_to_show);
    return ok();
  }

  Status run(double dt, int steps) {
    at_trial_(dt, std::min(0.95, static_cast<double>(trials_.size()) / trials_expected));
    scene::Scene scene = scene_;
    scene.solver.dt = dt;
    const Result<sim::Simulation*> simulation = full_.prepare(scene);
    if (!simulation) return simulation.error();
    Result<EnergyTrial> trial = run_trial(**simulation, steps, stop_);
    if (!trial) return trial.error();
    measured_.time = std::max(measured_.time, steps * dt);
    measured_.steps = std::max(measured_.steps, steps);
    trials_.push_back(*trial);
    std::sort(trials_.begin(), trials_.end(),
              [](const EnergyTrial& a, const EnergyTrial& b) { return a.dt < b.dt; });
    return ok();
  }
  /// The number of steps of a trial with the step `dt` [s]: within bounds, all trials of a column simulate
  /// the same time, so that their energies can be compared.
  int steps_of(double dt) const {
    return std::clamp(static_cast<int>(std::round(time_ / dt)), 32, static_cast<int>(farthest * most_steps_));
  }
  Status run(double dt) { return run(dt, steps_of(dt)); }

  const EnergyTrial* shortest_failed() const {
    const auto found =
        std::find_if(trials_.begin(), trials_.end(), [](const EnergyTrial& t) { return t.blew_up; });
    return found == trials_.end() ? nullptr : &*found;
  }
  const EnergyTrial* longest_held() const {
    const EnergyTrial* held = nullptr;
    for (const EnergyTrial& trial : trials_) {
      if (trial.blew_up) break;
      held = &trial;
    }
    return held;
  }

  Status try_around_limit() {
    const double shown =
        std::isfinite(shortest_visible_dt_) ? std::max(*theory_, shortest_visible_dt_) : *theory_;
    const double low = (*theory_ > 0.0 ? *theory_ : shown) / farthest, high = shown * farthest;
    time_ = most_steps_ * shown;
    for (int row = 0; row < rows; ++row)
      if (const Status done = run(in_range(low * std::pow(high / low, row / (rows - 1.0)))); !done)
        return done;
    for (int doubling = 0; doubling < 6 && !shortest_failed(); ++doubling)
      if (const Status done = run(in_range(2.0 * trials_.back().dt)); !done) return done;
    for (int halving = 0; halving < 8 && !longest_held(); ++halving)
      if (const Status done = run(in_range(0.5 * trials_.front().dt)); !done) return done;
    while (shortest_failed() && longest_held() && shortest_failed()->dt / longest_held()->dt > precision)
      if (const Status done = run(std::sqrt(shortest_failed()->dt * longest_held()->dt)); !done) return done;
    return ok();
  }

  Status try_long_steps() {
    for (const double dt : long_steps)
      if (const Status done = run(dt, long_steps_run); !done) return done;
    return ok();
  }

  static double in_range(double dt) {
    return std::clamp(dt, scene::ranges::dt.minimum, scene::ranges::dt.maximum);
  }

  void conclude() {
    MapColumn& column = measured_.column;
    if (const EnergyTrial* held = longest_held()) column.held = held->dt;
    if (const EnergyTrial* failed = shortest_failed()) column.failed = failed->dt;
    for (const EnergyTrial& trial : trials_)
      measured_.held_beyond =
          measured_.held_beyond || (column.failed && trial.dt > *column.failed && !trial.blew_up);
    const double stable = stable_energy();
    for (const EnergyTrial& trial : trials_) {
      double growth = trial.finite ? std::log10(trial.most / stable) : most_growth;
      if (!std::isfinite(growth)) growth = 0.0;
      column.cells.push_back({trial.dt, std::clamp(growth, 0.0, most_growth), trial.blew_up});
    }
  }

  /// The largest energy of the shortest step that held [J]; where the bound on steps cut its time short, of
  /// a longer step that held for a longer time. If no step held: of the shortest step.
  double stable_energy() const {
    const EnergyTrial* stable = nullptr;
    for (const EnergyTrial& trial : trials_)
      if (!trial.blew_up && (!stable || trial.time > 1.05 * stable->time)) stable = &trial;
    return stable ? stable->most : trials_.front().most;
  }

  Status explain() {
    MapColumn& column = measured_.column;
    if (!disagrees(column)) return ok();
    column.disagrees = true;
    const Evidence evidence{scene_,
                            mode_,
                            shortest_visible_dt_,
                            most_steps_,
                            [this](double dt) { return theory_ ? steps_of(dt) : long_steps_run; },
                            shortest_failed() ? shortest_failed()->why : ""};
    const Result<Explanation> found = lab::explain(column, evidence, full_, bare_, stop_);
    if (!found) return found.error();
    measured_.cause = found->cause;
    column.reason = found->reason;
    return ok();
  }

  const scene::Scene& scene_;
  ReusedSimulation &full_, &bare_;
  const std::stop_token& stop_;
  const AtTrial& at_trial_;
  std::optional<double> theory_;
  model::Mode mode_;
  double shortest_visible_dt_ = 0, time_ = 0;
  int most_steps_ = 0;
  std::vector<EnergyTrial> trials_;  // sorted by rising dt
  MeasuredColumn measured_;
};

}  // namespace

Result<sim::Simulation*> ReusedSimulation::prepare(const scene::Scene& scene) {
  if (!simulation_) {
    Result<std::unique_ptr<sim::Simulation>> made = sim::Simulation::create(scene);
    if (!made) return made.error();
    simulation_ = std::move(*made);
  } else if (Result<sim::ChangeDepth> changed = simulation_->change(scene); !changed) {
    return changed.error();
  }
  return simulation_.get();
}

Result<MeasuredColumn> measure_column(const scene::Scene& scene, double value, ReusedSimulation& full,
                                      ReusedSimulation& bare, const std::stop_token& stop,
                                      const AtTrial& at_trial) {
  return Column(scene, full, bare, stop, at_trial).measure(value);
}

}  // namespace clothlab::lab
