#include "server/lab/measure/substitutes.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/base/text.h"
#include "server/lab/measure/coarsen.h"
#include "server/model/stability.h"
#include "server/reference/trajectory.h"
#include "server/scene/ranges.h"

namespace clothlab::lab {

namespace {

using scene::Document;

constexpr double truth_budget = 20.0;  // wall time of the reference [s]
constexpr double longest_substitute_timing =
    0.15;                               // longest timing, wall time [s]; a short round sees a steady machine
constexpr double timing_budget = 40.0;  // wall time [s] after which no rounds beyond looks[0] are added
/// Without a reference, a copy whose masses are larger by the share `copy_mass_increase` shows if the motion
/// is chaotic: if its distance over the size is more than `most_amplified` times that share.
constexpr double copy_mass_increase = 1e-4, most_amplified = 100.0;

}  // namespace

bool Substitute::coarser() const {
  return std::any_of(parts.begin(), parts.end(), [](const Part* part) { return part->coarser > 1; });
}

bool Substitute::own_step() const {
  return std::any_of(parts.begin(), parts.end(), [](const Part* part) { return part->own_step; });
}
bool Substitute::excludes(const Part& part) const {
  return part.of != PartOf::nothing &&
         std::any_of(parts.begin(), parts.end(), [&](const Part* mine) { return mine->of == part.of; });
}

Status Substitutes::start(double time, const std::function<void(double share)>& progress,
                          std::vector<std::string>& notes) {
  const scene::Scene& scene = whole_.document.scene;
  TruthRequest request{time, 1e-6, truth_budget};
  // What a part changes is measured against the whole scene, which has that contact.
  request.beyond_touch = true;
  Result<Truth> truth = lab::truth(scene, request, stop_, progress);
  if (!truth) return truth.error();
  truth_ = std::move(*truth);
  notes = truth_.notes;
  if (scene.collides(scene::ContactKind::surface) ||
      std::any_of(scene.colliders.begin(), scene.colliders.end(),
                  [](const scene::Collider& of) { return of.is_body(); }))
    notes.push_back(
        "The reference knows no contact of surfaces, of cloths or of bodies of triangles: it is the true "
        "motion until they touch.");
  if (truth_.why_no_reference.empty()) {
    notes.push_back(truth_.horizon_reason);
    if (truth_.horizon > 0.0 && truth_.horizon < truth_.time)
      notes.push_back(
          "Effects of a part after the horizon, such as a later contact, are not counted in its change.");
    if (truth_.horizon == 0.0)
      notes.push_back(
          "Energy and the largest strain can still be compared, and are given; a part is recommended to be "
          "dropped only where positions can be.");
  } else {
    notes.push_back("There is no reference (" + truth_.why_no_reference +
                    "): errors are not known, only what each part changes.");
    // The sample times are kept, so that runs can be compared with each other.
    without_truth_ = truth_.time = time;
    truth_.spacing = time / samples_to_horizon;
    truth_.energy.clear();
    truth_.strain.clear();
    truth_.position.clear();
  }
  whole_.variant.name = "the whole scene";
  whole_.variant.patch = scene::json::object();
  if (Status measured = run(whole_); !measured) return measured;
  return whole_.variant.measured && !truth_.why_no_reference.empty() ? compare_without_truth(notes) : ok();
}

/// Without a reference no horizon is known: a copy with slightly larger masses shows if positions can be
/// compared at the end of the time.
Status Substitutes::compare_without_truth(std::vector<std::string>& notes) {
  Substitute copy = whole_;
  for (scene::Cloth& cloth : copy.document.scene.cloths) cloth.mass.value *= 1.0 + copy_mass_increase;
  if (Status measured = run(copy); !measured) return measured;
  const double apart = copy.variant.change.value_or(1.0);
  if (copy.variant.measured && apart <= most_amplified * copy_mass_increase) return ok();
  notes.push_back(formatted(
      "The vertices of a copy with masses %.3g %% larger are off by %.3g %% of the cloth's size after "
      "%.3g s: positions cannot be compared, and nothing is recommended.",
      100 * copy_mass_increase, 100 * apart, truth_.time));
  without_truth_ = 0.0;
  whole_.variant.change.reset();
  return ok();
}

Status Substitutes::measure(Substitute& candidate, Document document) {
  candidate.document = std::move(document);
  if (candidate.own_step())
    if (Status stepped = same_share_of_limit(candidate); !stepped) return stepped;
  candidate.variant.patch = merge_patch(whole_.document.value, candidate.document.value);
  return run(candidate);
}

/// Sets the step to the same share of the limit as in the whole scene: a coarser mesh or a simpler model may
/// allow longer steps, which are most of its saving, or need shorter ones.
Status Substitutes::same_share_of_limit(Substitute& candidate) {
  const Result<double> limit = limit_of(candidate.document.scene);
  if (!limit) return limit.error();
  const double before = whole_.variant.dt_limit;
  if (!std::isfinite(*limit) || !std::isfinite(before) || before == 0.0) return ok();
  const double dt = std::min({whole_.document.scene.solver.dt * *limit / before, scene::ranges::dt.maximum,
                              truth_.spacing * samples_to_horizon / 4});
  scene::json value = candidate.document.value;
  value["solver"]["dt"] = dt;
  Result<Document> stepped = scene::validate(std::move(value), candidate.document.assets);
  if (!stepped) return stepped.error();
  candidate.document = std::move(*stepped);
  return ok();
}

Result<double> Substitutes::limit_of(const scene::Scene& scene) const {
  const Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  const double limit = model::dt_limit(scene.solver.method, *model, scene, stop_);
  if (stop_.stop_requested()) return cancelled;
  return limit;
}

/// Runs the candidate and fills in errors, change and step limit; the cost is measured later, in turns.
Status Substitutes::run(Substitute& candidate) {
  Variant& variant = candidate.variant;
  const scene::Scene& scene = candidate.document.scene;
  const Result<double> limit = limit_of(scene);
  if (!limit) return limit.error();
  variant.dt_limit = *limit;
  // A coarser mesh has different vertices: compare() interpolates its positions before it compares them.
  Truth truth_without_positions = truth_;
  truth_without_positions.position.clear();
  const Result<Trial> trial =
      trials_.run(scene, candidate.coarser() ? truth_without_positions : truth_, truth_.time, stop_);
  if (!trial) return trial.error();
  if (trial->blew_up_at) {
    variant.reason = "it blew up at " + formatted("%.3g s", *trial->blew_up_at);
    return ok();
  }
  variant.error = trial->error;
  variant.measured = true;
  return compared_at() > 0.0 ? compare(candidate, *trial) : ok();
}

Status Substitutes::compare(Substitute& candidate, const Trial& trial) {
  if (!trial.at_horizon.empty()) {
    candidate.at_horizon.assign(trial.at_horizon.begin(), trial.at_horizon.end());
  } else {
    scene::Scene scene = candidate.document.scene;
    scene.solver.dt = fitted_dt(scene.solver.dt, truth_);
    const auto state = trials_.run_to(scene, compared_at(), stop_);
    if (!state) return state.error();
    if (!*state) return ok();
    candidate.at_horizon = at_fine_vertices(whole_.document.scene, scene, (*state)->position);
    if (!truth_.position.empty())
      candidate.variant.error[index(Axis::position)] =
          reference::rms_distance(candidate.at_horizon, truth_.position.back()) / truth_.size;
  }
  const std::vector<glm::dvec3>& whole = &candidate == &whole_ ? candidate.at_horizon : whole_.at_horizon;
  candidate.variant.change = reference::rms_distance(candidate.at_horizon, whole) / truth_.size;
  return ok();
}

Result<std::vector<std::vector<double>>> Substitutes::turns(const std::vector<const scene::Scene*>& scenes,
                                                            std::vector<CostComparison>& comparisons) {
  const auto time = [&](std::size_t thing) -> Result<double> {
    if (stop_.stop_requested()) return cancelled;
    if (timer_) return timer_(*scenes[thing]);
    const auto times = trials_.time({*scenes[thing]}, truth_.time, longest_substitute_timing, 1, stop_);
    if (!times) return times.error();
    return times->front().front();
  };
  const auto begun = std::chrono::steady_clock::now();
  const auto more = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() < timing_budget;
  };
  return take_turns(scenes.size(), comparisons, time, more);
}

Status Substitutes::time(const std::vector<Substitute*>& candidates, double tolerance) {
  std::vector<const scene::Scene*> scenes{&whole_.document.scene};
  std::vector<CostComparison> comparisons;
  for (const Substitute* candidate : candidates) {
    scenes.push_back(&candidate->document.scene);
    const std::optional<double>& change = candidate->variant.change;
    comparisons.push_back({comparisons.size() + 1, 0, change && *change <= tolerance});
  }
  const auto times = turns(scenes, comparisons);
  if (!times) return times.error();
  whole_.variant.cost = cost_of(times->front());
  whole_.variant.cost_ratio = {1.0, 1.0, 1.0};
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Variant& variant = candidates[i]->variant;
    variant.cost = cost_of((*times)[i + 1]);
    variant.cost_ratio = comparisons[i].ratio;
    variant.saving = comparisons[i].saving;
  }
  return ok();
}

Result<CostComparison> Substitutes::time_over(Substitute& candidate, const Substitute& other) {
  std::vector<CostComparison> comparisons{{2, 1, true}, {2, 0, false}};
  const auto times =
      turns({&whole_.document.scene, &other.document.scene, &candidate.document.scene}, comparisons);
  if (!times) return times.error();
  candidate.variant.cost = cost_of(times->back());
  candidate.variant.cost_ratio = comparisons[1].ratio;
  candidate.variant.saving = comparisons[1].saving;
  return comparisons[0];
}

}  // namespace clothlab::lab
