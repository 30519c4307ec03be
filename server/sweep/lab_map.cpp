#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/lab/draw/plot.h"
#include "server/model/stability.h"
#include "server/scene/named_fabric.h"
#include "server/sweep/lab_results.h"

namespace clothlab::sweep {

namespace {

/// The trials of one method at one value of the axis.
struct Trials {
  lab::MapColumn column;
  double longest = 0;                 ///< dt of the longest trial [s]
  std::optional<double> of_longest;   ///< its `dt_limit_s`
  std::map<double, double> energies;  ///< largest kinetic + elastic energy [J] by dt, of those that held
};

lab::MapColumn finished(Trials trials) {
  lab::MapColumn& column = trials.column;
  std::sort(column.cells.begin(), column.cells.end(),
            [](const lab::MapCell& a, const lab::MapCell& b) { return a.dt < b.dt; });
  for (lab::MapCell& cell : column.cells) {
    if (cell.blew_up) {
      if (!column.failed) column.failed = cell.dt;
      continue;
    }
    if (!column.failed) column.held = cell.dt;
    const double growth = std::log10(trials.energies[cell.dt] / trials.energies.begin()->second);
    cell.growth = std::isfinite(growth) ? std::clamp(growth, 0.0, lab::most_growth) : 0.0;
  }
  // Far below the limit only a lower bound of it is known: then the limit is above all steps that were tried.
  if (trials.of_longest)
    column.theory = trials.longest > model::margin_to_warn * *trials.of_longest
                        ? *trials.of_longest
                        : std::numeric_limits<double>::infinity();
  return column;
}

}  // namespace

lab::StabilityMap lab_map(const Plan& plan, const Cells& cells, const Group& group, const Axis& axis) {
  lab::StabilityMap map;
  map.scene = title_of(plan, group);
  map.renderer = renderer_of(cells, group, map.notes);
  map.field = axis.name;
  const json spelled_out = scene::spelled_out(plan.base);
  const json::json_pointer place(axis.at[0]);
  const bool known = spelled_out.contains(place) && spelled_out[place].is_number();
  map.present_value = known ? spelled_out[place].get<double>() : std::nan("");
  map.present_dt = plan.base.scene.solver.dt;
  map.present_method = plan.base.scene.solver.method;
  map.time = plan.time;
  map.complete = group.rows.size() == group.points;
  std::map<scene::Method, std::map<double, Trials>> methods;
  std::size_t refused = 0;
  double shortest = std::numeric_limits<double>::infinity();
  for (const std::size_t row : group.rows) {
    const std::optional<lab::Setting> setting = cells.setting(row);
    const std::optional<double> value = cells.number(row, axis.name);
    if (!setting || !value) {
      ++refused;
      continue;
    }
    Trials& trials = methods[setting->method][*value];
    trials.column.value = *value;
    const bool blew_up = cells.number(row, "blew_up_at_s").has_value();
    if (const auto energy = cells.number(row, "largest_kinetic_and_elastic_j"); energy && !blew_up)
      trials.energies[setting->dt] = *energy;
    else if (!blew_up)
      continue;
    trials.column.cells.push_back({setting->dt, 0, blew_up});
    shortest = std::min(shortest, setting->dt);
    if (setting->dt > trials.longest) {
      trials.longest = setting->dt;
      trials.of_longest = cells.number(row, "dt_limit_s");
    }
  }
  for (auto& [method, columns] : methods) {
    map.methods.push_back({method, {}});
    for (auto& [value, trials] : columns) map.methods.back().columns.push_back(finished(std::move(trials)));
  }
  map.steps = static_cast<int>(std::round(plan.time / shortest));
  map.notes.push_back("\"" + axis.name + "\" is " + axis.at[0] +
                      (axis.at.size() > 1 ? " and " + lab::count(axis.at.size() - 1, "other place") : "") +
                      " in the scene.");
  note_absent(group, refused, map.notes);
  return map;
}

}  // namespace clothlab::sweep
