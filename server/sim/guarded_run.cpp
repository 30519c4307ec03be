#include "server/sim/guarded_run.h"

#include <algorithm>
#include <chrono>

namespace clothlab::sim {

double timed_steps(Simulation& simulation, std::uint32_t count) {
  const auto start = std::chrono::steady_clock::now();
  simulation.step(count);
  simulation.finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void GuardedRun::move_to(Simulation& simulation) {
  simulation_ = &simulation;
  verdict_requested_ = false;  // a diagnosis still on its way belongs to the old simulation
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
  verdict_requested_ = false;
  state_ = state;
  const Verdict verdict = blow_up_.judge(state);
  if (pull_before_.force > pull_.force || pull_before_.reach > pull_.reach) {
    pull_before_ = pull_;
    blow_up_.set_allowance(allowance());
  }
  if (verdict == Verdict::good) simulation_->keep_diagnosed();
  return verdict;
}

GuardedRun::Verdict GuardedRun::judge_now() {
  return judge(simulation_->diagnose());
}

void GuardedRun::request_verdict() {
  simulation_->request_diagnostics();
  verdict_requested_ = true;
}

std::optional<GuardedRun::Verdict> GuardedRun::poll_verdict() {
  Diagnostics arrived;
  if (!verdict_requested_ || !simulation_->poll_diagnostics(arrived)) return std::nullopt;
  return judge(arrived);
}

GuardedRun::Setback GuardedRun::go_back() {
  const scene::Scene& scene = simulation_->scene();
  Setback setback{blow_up_.reason() + model::against_limit(scene.solver, dt_limit_),
                  model::remedy(simulation_->model(), scene, dt_limit_)};
  simulation_->go_back();
  state_ = blow_up_.last_good();
  return setback;
}

}  // namespace clothlab::sim
