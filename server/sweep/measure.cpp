#include "server/sweep/measure.h"

#include <algorithm>
#include <cmath>

#include "server/base/hash.h"
#include "server/gl/context.h"
#include "server/lab/measure/stepping.h"
#include "server/lab/scene_hash.h"
#include "server/model/mesh_file.h"
#include "server/model/stability.h"
#include "server/sim/crossing_check.h"
#include "server/sim/guarded_run.h"
#include "server/sweep/quiet.h"

namespace clothlab::sweep {

namespace {

constexpr std::size_t most_truths = 4;  ///< kept at once: each has 64 copies of the cloth
constexpr int timed_rounds = 3;
constexpr double timed = 0.3;  ///< wall time of one timing at most [s]

Row number(double value) {
  return std::isfinite(value) ? Row(value) : Row();
}
Row number(const std::optional<double>& value) {
  return value ? number(*value) : Row();
}

/// The same for all scenes that differ only in how they are stepped.
std::string motion_key(scene::Document scene) {
  scene.value["solver"] = nullptr;
  Hash hash;
  lab::add_scene(hash, scene);
  return hash.text();
}

}  // namespace

Result<const lab::Truth*> Measurement::truth_of(const scene::Document& scene, const std::stop_token& stop) {
  const std::string key = motion_key(scene);
  const auto known =
      std::find_if(truths_.begin(), truths_.end(), [&](const Known& k) { return k.key == key; });
  if (known != truths_.end()) {
    truths_.splice(truths_.begin(), truths_, known);
    return &truths_.front().truth;
  }
  Result<lab::Truth> truth = lab::truth(scene.scene, {plan_.time, 1e-7, plan_.budget}, stop, [](double) {});
  if (!truth) return truth.error();
  if (truths_.size() == most_truths) truths_.pop_back();
  truths_.push_front({key, std::move(*truth)});
  return &truths_.front().truth;
}

Status Measurement::add_errors(const scene::Document& scene, Row& result, const std::stop_token& stop) {
  const Result<const lab::Truth*> known = truth_of(scene, stop);
  if (!known) return known.error();
  const lab::Truth& truth = **known;
  result["size_m"] = truth.size;
  result["horizon_s"] = truth.horizon;
  lab::Trial trial;
  if (truth.why_no_reference.empty()) {
    Result<lab::Trial> found = trials_.run(scene.scene, truth, truth.time, stop);
    if (!found) return found.error();
    trial = std::move(*found);
  }
  result["error"] = {{"position_over_size", number(trial.error[lab::index(lab::Axis::position)])},
                     {"largest_position_over_size", number(trial.largest_position_error)},
                     {"energy_share", number(trial.error[lab::index(lab::Axis::energy)])},
                     {"strain_share", number(trial.error[lab::index(lab::Axis::strain)])}};
  if (!truth.why_no_reference.empty()) {
    result["why_no_error"] = truth.why_no_reference;
    return ok();
  }
  if (truth.horizon > 0)
    result["reference_error"] = number(truth.position_error / truth.size);
  else
    result["why_no_error"] = truth.horizon_reason;
  return ok();
}

Status Measurement::add_cost(const scene::Scene& scene, Row& result, const std::stop_token& stop) {
  const Quiet quiet;
  const Result<std::vector<std::vector<double>>> times =
      trials_.time({scene}, plan_.time, timed, timed_rounds, stop);
  if (!times) return times.error();
  const std::optional<double> others = quiet.others();
  result["others_cores"] = number(others);
  if (!others || *others > Quiet::most_others) {
    result["cost"] = {
        {"median_ms_per_simulated_s", nullptr}, {"minimum_ms_per_simulated_s", nullptr}, {"timed_runs", 0}};
    result["why_no_cost"] = others ? "other programs worked on the same cores meanwhile"
                                   : "it cannot be told whether other programs worked on the same cores";
    return ok();
  }
  const lab::Cost cost = lab::cost_of(times->front());
  result["cost"] = {{"median_ms_per_simulated_s", number(cost.median)},
                    {"minimum_ms_per_simulated_s", number(cost.minimum)},
                    {"timed_runs", cost.runs}};
  return ok();
}

/// Runs the scene to its end and looks at its state on the way. Returns the mesh at the end, if asked for.
Result<std::string> Measurement::add_run(const scene::Scene& scene, Row& result,
                                         const std::stop_token& stop) {
  const Result<sim::Simulation*> prepared = trials_.prepare(scene);
  if (!prepared) return prepared.error();
  sim::Simulation& simulation = **prepared;
  sim::GuardedRun guard(simulation);
  const double dt_limit = model::dt_limit_if_near(simulation.model(), scene);
  guard.start(dt_limit);
  std::optional<sim::CrossingCheck> crossings;
  if (plan_.quantities.crossings) crossings.emplace(simulation);
  result["vertices"] = simulation.model().vertex_count();
  const auto steps = static_cast<std::uint64_t>(std::max(1.0, std::round(plan_.time / scene.solver.dt)));
  const auto apart = static_cast<std::uint64_t>(std::max(1.0, std::round(plan_.every / scene.solver.dt)));
  lab::Stepping stepping(simulation);
  double strain = 0, speed = 0, energy = 0;
  std::uint64_t done = 0;
  bool held = true;
  while (held && done < steps) {
    const std::uint64_t next = std::min((done / apart + 1) * apart, steps);
    while (done < next) {
      if (stop.stop_requested()) return lab::cancelled;
      done += stepping.step(next - done);
    }
    held = guard.judge_now() != sim::GuardedRun::Verdict::blown_up;
    if (!held) break;
    strain = std::max(strain, guard.state().max_strain);
    speed = std::max(speed, guard.state().max_speed);
    energy = std::max(energy, guard.state().kinetic + guard.state().elastic);
    if (crossings) crossings->add(simulation.read_state(), guard.state().time);
  }
  result["dt_limit_s"] = number(dt_limit);
  result["blew_up_at_s"] = held ? Row() : number(static_cast<double>(done) * scene.solver.dt);
  result["largest_strain"] = number(strain);
  result["largest_speed_m_per_s"] = number(speed);
  result["largest_kinetic_and_elastic_j"] = number(energy);
  const sim::Diagnostics& last = held ? guard.state() : guard.last_good();
  result["end"] = {{"time_s", number(last.time)},
                   {"kinetic_j", number(last.kinetic)},
                   {"elastic_j", number(last.elastic)},
                   {"gravitational_j", number(last.gravitational)}};
  if (crossings) {
    crossings->report(result);
  }
  if (!plan_.quantities.shape || !held) return std::string();
  return model::ply_bytes(simulation.model(), simulation.read_state().position,
                          "Clothlab, a point of a sweep");
}

Result<Measured> Measurement::measure(const scene::Document& scene, const std::stop_token& stop) {
  Measured measured;
  Row& result = measured.result;
  const json setting = lab::to_json(lab::setting_of(scene.scene));
  for (const char* name : {"method", "dt_s", "iterations", "tolerance"}) result[name] = setting[name];
  result["renderer"] = gl::renderer_name();
  result["version"] = CLOTHLAB_VERSION;
  Result<std::string> shape = add_run(scene.scene, result, stop);
  if (!shape) return shape.error();
  measured.shape = std::move(*shape);
  if (!result["blew_up_at_s"].is_null()) return measured;
  if (plan_.quantities.error)
    if (Status added = add_errors(scene, result, stop); !added) return added.error();
  if (plan_.quantities.cost)
    if (Status added = add_cost(scene.scene, result, stop); !added) return added.error();
  return measured;
}

}  // namespace clothlab::sweep
