#include <array>

#include "server/lab/draw/plot.h"
#include "server/sweep/lab_results.h"

namespace clothlab::sweep {

namespace {

/// In the order of lab::Axis.
constexpr std::array error_columns{"error_position_over_size", "error_energy_share", "error_strain_share"};

}  // namespace

lab::Chart lab_chart(const Plan& plan, const Cells& cells, const Group& group) {
  lab::Chart chart;
  chart.scene = title_of(plan, group);
  chart.renderer = renderer_of(cells, group, chart.notes);
  chart.time = plan.time;
  chart.present = lab::setting_of(plan.base.scene);
  chart.complete = group.rows.size() == group.points;
  std::size_t refused = 0, without_cost = 0;
  for (const std::size_t row : group.rows) {
    const std::optional<lab::Setting> setting = cells.setting(row);
    if (!setting) {
      ++refused;
      continue;
    }
    lab::Point point;
    point.setting = *setting;
    for (std::size_t e = 0; e < error_columns.size(); ++e) {
      point.error[e] = cells.number(row, error_columns[e]);
      chart.axes[e].available |= point.error[e].has_value();
      if (chart.axes[e].reason.empty()) chart.axes[e].reason = cells.text(row, "why_no_error");
    }
    point.blew_up_at = cells.number(row, "blew_up_at_s");
    if (const auto median = cells.number(row, "cost_median_ms_per_simulated_s")) {
      point.cost.emplace();
      point.cost->median = *median;
      point.cost->minimum = cells.number(row, "cost_minimum_ms_per_simulated_s").value_or(*median);
      point.cost->runs = static_cast<int>(cells.number(row, "cost_timed_runs").value_or(0));
    }
    without_cost += !point.cost && !point.blew_up_at;
    chart.size = cells.number(row, "size_m").value_or(chart.size);
    chart.horizon = cells.number(row, "horizon_s").value_or(chart.horizon);
    if (const auto reference = cells.number(row, "reference_error"))
      chart.axes[0].reference_error = reference;
    chart.points.push_back(point);
  }
  if (!chart.axes[0].available && !chart.axes[0].reason.empty())
    chart.notes.push_back("No error of positions: " + chart.axes[0].reason + ".");
  if (without_cost > 0)
    chart.notes.push_back(lab::count(without_cost, "point is", "points are") +
                          " not here: other programs worked on the same cores while the cost was measured.");
  note_absent(group, refused, chart.notes);
  return chart;
}

}  // namespace clothlab::sweep
