#include "server/sim/guarded_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/model/stability.h"
#include "server/sim/motion_table.h"

namespace clothlab::sim {

std::uint32_t judged_every(const scene::Scene& scene, const model::Model& model) {
  constexpr double a_second = 60;
  const double dt = scene.solver.dt, most = dt > model::margin_to_warn * model::dt_limit_bound(model, scene)
                                                ? batch_steps / 8
                                                : batch_steps;
  return static_cast<std::uint32_t>(std::clamp(std::round(1.0 / (a_second * dt)), 1.0, most));
}

double timed_steps(Simulation& simulation, std::uint32_t count) {
  const double measured = simulation.measuring_seconds();
  const auto start = std::chrono::steady_clock::now();
  simulation.step(count);
  simulation.finish();
  const double all = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return all - (simulation.measuring_seconds() - measured);
}

void GuardedRun::move_to(Simulation& simulation) {
  simulation_ = &simulation;
  verdict_requested_ = false;  // a diagnosis still on its way belongs to the old simulation
  judge_every(every_);
}

void GuardedRun::judge_every(std::uint32_t steps) {
  every_ = steps;
  simulation_->diagnose_every(steps);
}

Allowance GuardedRun::allowance() const {
  Allowance allowed = sim::allowance(simulation_->scene(), simulation_->model(), dt_limit_);
  if (swing_) allowed.energy_ratio = *swing_;
  allowed.hand_force = std::max(pull_.force, pull_before_.force);
  allowed.hand_reach = std::max(pull_.reach, pull_before_.reach);
  return allowed;
}

void GuardedRun::start(double dt_limit, std::optional<double> swing) {
  dt_limit_ = dt_limit;
  swing_ = swing;
  state_ = simulation_->diagnose();
  judged_step_ = state_.step;
  verdict_requested_ = false;
  blow_up_.start(allowance(), state_);
}

void GuardedRun::set_dt_limit(double dt_limit) {
  dt_limit_ = dt_limit;
  blow_up_.set_allowance(allowance());
}

void GuardedRun::set_hands(double force, double reach) {
  pull_before_ = {std::max(pull_.force, pull_before_.force), std::max(pull_.reach, pull_before_.reach)};
  pull_ = {force, reach};
  blow_up_.set_allowance(allowance());
}

void GuardedRun::rebase() {
  blow_up_.rebase(simulation_->diagnose());
  verdict_requested_ = false;
}

GuardedRun::Verdict GuardedRun::judge(const Diagnostics& state) {
  judged_step_ = state.step;
  state_ = state;
  const Verdict verdict = blow_up_.judge(state);
  if (pull_before_.force > pull_.force || pull_before_.reach > pull_.reach) {
    pull_before_ = pull_;
    blow_up_.set_allowance(allowance());
  }
  if (verdict == Verdict::good) simulation_->keep_diagnosed();
  return verdict;
}

/// Judges a state that has arrived, if its turn has come.
GuardedRun::Verdict GuardedRun::take(const Diagnostics& state) {
  if (state.step >= requested_step_) verdict_requested_ = false;
  if (every_ == 0 || (state.step % every_ == 0 && state.step > judged_step_)) return judge(state);
  state_ = state;
  return Verdict::unjudged;
}

GuardedRun::Verdict GuardedRun::judge_now() {
  Diagnostics arrived;
  while (simulation_->poll_diagnostics(arrived, true))
    if (every_ > 0 && take(arrived) == Verdict::blown_up) return Verdict::blown_up;
  verdict_requested_ = false;
  return judge(simulation_->diagnose());
}

void GuardedRun::look() {
  state_ = simulation_->diagnose();
}

void GuardedRun::request_verdict() {
  simulation_->request_diagnostics();
  requested_step_ = simulation_->step_index();
  verdict_requested_ = true;
}

std::optional<GuardedRun::Verdict> GuardedRun::poll_verdict() {
  Diagnostics arrived;
  if (!(verdict_requested_ || every_ > 0) || !simulation_->poll_diagnostics(arrived)) return std::nullopt;
  return take(arrived);
}

GuardedRun::Setback GuardedRun::go_back() {
  const scene::Scene& scene = simulation_->scene();
  Setback setback{blow_up_.reason() + model::against_limit(scene.solver, dt_limit_),
                  model::remedy(simulation_->model(), scene, dt_limit_), blow_up_.energy()};
  simulation_->go_back();
  verdict_requested_ = false;
  state_ = blow_up_.last_good();
  return setback;
}

}  // namespace clothlab::sim
