#include "server/lab/measure/whole_time.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "server/base/text.h"
#include "server/lab/measure/control.h"
#include "server/lab/measure/stepping.h"
#include "server/model/stability.h"
#include "server/sim/guarded_run.h"

namespace clothlab::lab {

namespace {

constexpr int fewest_looks_at_whole = 4, most_looks_at_whole = 32;  // evenly spread over the time
/// The run that strain is compared with. Cotton of 25x25 vertices is then within 0.6 mm of 1 m after a
/// quarter of a second (tests/README.md), far less than what folds differ by in strain.
constexpr double longest_solved_step = 1.0 / 240;  // [s]
constexpr int most_newton_steps = 10;
constexpr double solved_tolerance = 1e-5;
/// Beyond a horizon folds are others, and so is the largest strain. Sweeps that are far from solved have
/// several times as much.
constexpr double strain_of_chaos = 1.5;
/// Energy that rounding and a longest stable step may add, as a share of the largest of motion and stretch.
constexpr double energy_of_rounding = 0.01;

glm::dvec3 centre_of_free(const sim::State& state, const model::Model& model) {
  glm::dvec3 sum(0.0);
  double free = 0.0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    if (model.pin_motion[i] != model::not_pinned) continue;
    sum += glm::dvec3(state.position[i]);
    free += 1.0;
  }
  return sum / std::max(free, 1.0);
}

/// True if wind, keys, or a pin or collider that moves may give energy to the cloth.
bool does_work(const scene::Scene& scene, const model::Model& model) {
  return scene.wind || !scene.keys.empty() || scene::any_has_motion(scene.colliders) ||
         std::any_of(model.motions.begin(), model.motions.end(), scene::has_motion);
}

}  // namespace

WholeTime::WholeTime(const scene::Scene& scene, const Truth& truth, double tolerance, TrialRunner& trials,
                     std::stop_token stop)
    : scene_(scene), truth_(truth), tolerance_(tolerance), trials_(trials), stop_(std::move(stop)) {}

Result<WholeTime::Run> WholeTime::run(Setting setting, int looks) {
  const double spacing = truth_.asked / looks;
  const auto steps =
      static_cast<std::uint32_t>(std::max(1.0, std::ceil(spacing / setting.dt * (1.0 - 1e-9))));
  setting.dt = spacing / steps;
  const scene::Scene scene = with(scene_, setting);
  const Result<sim::Simulation*> prepared = trials_.prepare(scene);
  if (!prepared) return prepared.error();
  sim::Simulation& simulation = **prepared;
  simulation.measure_convergence(true);
  sim::GuardedRun guard(simulation);
  guard.start(model::dt_limit_if_near(simulation.model(), scene));
  const double start = simulation.diagnose().total_energy();
  Run run;
  std::uint64_t measured = 0;
  for (int look = 0; look < looks; ++look) {
    Stepping stepping(simulation);
    for (std::uint32_t done = 0; done < steps;) {
      if (stop_.stop_requested()) return cancelled;
      done += stepping.step(steps - done);
    }
    if (guard.judge_now() == sim::GuardedRun::Verdict::blown_up) {
      run.blew_up_at = (look + 1) * spacing;
      return run;
    }
    const sim::Diagnostics& now = guard.state();
    run.largest_strain = std::max(run.largest_strain, now.max_strain);
    run.energy_scale = std::max(run.energy_scale, now.kinetic + now.elastic);
    run.gained = std::max(run.gained, now.total_energy() - start);
    run.centre.push_back(centre_of_free(simulation.read_state(), simulation.model()));
    if (const sim::Convergence& step = simulation.convergence(); step.measured > measured) {
      ++run.measured;
      run.mean_error += (step.error - run.mean_error) / run.measured;
      measured = step.measured;
    }
  }
  return run;
}

double WholeTime::allowed_error(const Setting& setting) const {
  const double all = tolerance_ * truth_.size;
  return scene::sweeps(setting.method) ? all : all * setting.dt / truth_.asked;
}

Result<std::string> WholeTime::fault(const Setting& setting) {
  const int looks = static_cast<int>(
      std::clamp(truth_.asked / setting.dt, double{fewest_looks_at_whole}, double{most_looks_at_whole}));
  const Result<Run> whole = run(setting, looks);
  if (!whole) return whole.error();
  const auto at = [](double time) { return with_significant_digits(time, 3) + " s"; };
  if (whole->blew_up_at) return "blows up before " + at(*whole->blew_up_at);
  if (whole->mean_error > allowed_error(setting))
    return "its steps are far from solved, by " + with_significant_digits(1000.0 * whole->mean_error, 2) +
           " mm each";
  if (!does_work(scene_, truth_.world.model) && whole->gained > energy_of_rounding * whole->energy_scale)
    return "its energy rises by " + with_significant_digits(whole->gained, 2) +
           " J, and nothing gives it any";
  if (!solved_) {
    Result<Run> solved = run({scene::Method::bdf2, longest_solved_step, most_newton_steps, solved_tolerance},
                             most_looks_at_whole);
    if (!solved) return solved.error();
    solved_ = std::move(*solved);
  }
  if (!solved_->blew_up_at && whole->largest_strain > strain_of_chaos * solved_->largest_strain + tolerance_)
    return "it stretches the cloth by " + percent(whole->largest_strain) +
           ", where steps that are solved do by " + percent(solved_->largest_strain);
  Setting finer = setting;
  finer.dt /= 2;
  const Result<Run> half = run(finer, looks);
  if (!half) return half.error();
  if (half->blew_up_at) return "half of its step blows up before " + at(*half->blew_up_at);
  for (std::size_t look = 0; look < half->centre.size(); ++look) {
    const double apart = glm::distance(half->centre[look], whole->centre[look]) / truth_.size;
    if (apart > tolerance_)
      return "half of its step leads the cloth's centre to another place, " + percent(apart) +
             " of the size away at " + at(truth_.asked * static_cast<double>(look + 1) / looks);
  }
  return std::string();
}

}  // namespace clothlab::lab
