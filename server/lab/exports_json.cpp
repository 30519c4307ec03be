// Results of the lab as JSON. A number that is not finite becomes null.
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

json number(double value) {
  return std::isfinite(value) ? json(value) : json();
}

json number(const std::optional<double>& value) {
  return value ? number(*value) : json();
}

/// One end of an interval; null where there were too few values for an interval.
json end_of(const Spread& spread, double end) {
  return std::isfinite(spread.high) ? number(end) : json();
}

json of(const Errors& errors) {
  json object = json::object();
  for (const Axis axis : all_axes) object[name(axis)] = number(errors[static_cast<std::size_t>(axis)]);
  return object;
}

json of(const std::optional<Cost>& cost) {
  if (!cost) return {};
  const bool tells = std::isfinite(cost->high);
  return {{"median", number(cost->median)},
          {"minimum", number(cost->minimum)},
          {"runs", cost->runs},
          {"low", tells ? number(cost->low) : json()},
          {"high", number(cost->high)}};
}

json of(const Point& point) {
  json object = to_json(point.setting);
  object["error"] = of(point.error);
  object["largest_position_error"] = number(point.largest_position_error);
  object["largest_position_error_low"] = number(point.error_low);
  object["largest_position_error_high"] = number(point.error_high);
  object["ms_a_simulated_s"] = of(point.cost);
  object["blew_up_at_s"] = number(point.blew_up_at);
  object["convergence"] = nullptr;
  if (point.step_error)
    object["convergence"] = {{"residual", number(point.residual)}, {"error_m", number(point.step_error)}};
  object["dt_over_limit"] = number(point.dt_over_limit);
  object["patch"] = patch(point.setting);
  return object;
}

json of(const LeftOut& left_out);
json of(const MapCell& cell);
json of(const MapColumn& column);
json of(const MethodMap& map);
json of(const Variant& variant);

template <class Item>
json list_of(const std::vector<Item>& items) {
  json list = json::array();
  for (const Item& item : items) list.push_back(of(item));
  return list;
}

json of(const LeftOut& left_out) {
  return {{"method", scene::name(left_out.method)},
          {"dt_s", number(left_out.dt)},
          {"iterations", left_out.iterations ? json(*left_out.iterations) : json()},
          {"reason", left_out.reason}};
}

json of(const AxisFacts& facts) {
  return {{"available", facts.available},
          {"reason", facts.reason},
          {"reference_error", number(facts.reference_error)},
          {"float32_floor", number(facts.float32_floor)}};
}

/// The members that every result of the lab starts with.
template <class Result>
json heading(const char* kind, const Result& result) {
  return {{"kind", kind},
          {"scene", result.scene},
          {"renderer", result.renderer},
          {"scene_hash", result.origin.scene_hash},
          {"date", result.origin.date},
          {"time_s", number(result.time)},
          {"complete", result.complete},
          {"notes", result.notes}};
}

json of(const Chart& chart) {
  json axes = json::object();
  for (const Axis axis : all_axes) axes[name(axis)] = of(chart.axes[static_cast<std::size_t>(axis)]);
  json result = heading("chart", chart);
  result.update({{"size_m", number(chart.size)},
                 {"horizon_s", number(chart.horizon)},
                 {"horizon_reason", chart.horizon_reason},
                 {"present", to_json(chart.present)},
                 {"axes", axes},
                 {"lines", {{"real_time_ms", real_time}, {"one_pixel", one_pixel}}},
                 {"points", list_of(chart.points)},
                 {"left_out", list_of(chart.left_out)}});
  return result;
}

json of(const MapCell& cell) {
  return {{"dt_s", number(cell.dt)}, {"growth", number(cell.growth)}, {"blew_up", cell.blew_up}};
}

json of(const MapColumn& column) {
  return {{"value", number(column.value)}, {"theory_s", number(column.theory)},
          {"held_s", number(column.held)}, {"failed_s", number(column.failed)},
          {"disagrees", column.disagrees}, {"reason", column.reason},
          {"cells", list_of(column.cells)}};
}

json of(const MethodMap& map) {
  return {{"method", scene::name(map.method)}, {"columns", list_of(map.columns)}};
}

json of(const StabilityMap& map) {
  json result = heading("stability", map);
  result.update({{"field", map.field},
                 {"unit", map.unit},
                 {"present",
                  {{"value", number(map.present_value)},
                   {"dt_s", number(map.present_dt)},
                   {"method", scene::name(map.present_method)}}},
                 {"steps", map.steps},
                 {"methods", list_of(map.methods)}});
  return result;
}

json of(const Choice& choice) {
  json result = heading("choose", choice);
  result.update({{"tolerance", number(choice.tolerance)},
                 {"asked_s", number(choice.asked)},
                 {"horizon_s", number(choice.horizon)},
                 {"horizon_reason", choice.horizon_reason},
                 {"reference_error", number(choice.reference_error)},
                 {"met", choice.met},
                 {"chosen", of(choice.chosen)},
                 {"runner_up", choice.runner_up ? of(*choice.runner_up) : json()},
                 {"present", of(choice.present)},
                 {"why", choice.why},
                 {"patch", patch(choice.chosen.setting)},
                 {"tried", list_of(choice.tried)}});
  return result;
}

json of(const Variant& variant) {
  return {{"name", variant.name},
          {"patch", variant.patch},
          {"measured", variant.measured},
          {"reason", variant.reason},
          {"error", of(variant.error)},
          {"change", number(variant.change)},
          {"ms_a_simulated_s", of(variant.cost)},
          {"cost_ratio", variant.cost ? number(variant.cost_ratio.median) : json()},
          {"cost_ratio_low", end_of(variant.cost_ratio, variant.cost_ratio.low)},
          {"cost_ratio_high", end_of(variant.cost_ratio, variant.cost_ratio.high)},
          {"saves", variant.saving == Saving::unknown ? json() : json(name(variant.saving))},
          {"dt_limit_s", number(variant.dt_limit)},
          {"drop", variant.recommended_to_drop}};
}

json of(const Simplification& simplification) {
  json result = heading("simplify", simplification);
  result.update({{"tolerance", number(simplification.tolerance)},
                 {"horizon_s", number(simplification.horizon)},
                 {"size_m", number(simplification.size)},
                 {"setting", to_json(simplification.setting)},
                 {"whole", of(simplification.whole)},
                 {"variants", list_of(simplification.variants)},
                 {"recommended", of(simplification.recommended)},
                 {"why", simplification.why}});
  return result;
}

json of(const ComparedSide& side) {
  json object = to_json(side.setting);
  object["blew_up_at_s"] = number(side.blew_up_at);
  object["reason"] = side.reason;
  return object;
}

json of(const Comparison& comparison) {
  json result = heading("compare", comparison);
  json times = json::array(), rms = json::array(), most = json::array();
  for (const auto& moment : comparison.moments) {
    times.push_back(moment->time);
    rms.push_back(number(moment->rms));
    most.push_back(number(moment->most));
  }
  result.update({{"rate", comparison.rate},
                 {"vertices", comparison.vertices},
                 {"truth", comparison.truth},
                 {"horizon_s", number(comparison.horizon)},
                 {"reference_error_m", comparison.truth ? number(comparison.reference_error) : json()},
                 {"a", of(comparison.a)},
                 {"b", of(comparison.b)},
                 {"times_s", std::move(times)},
                 {"rms_m", std::move(rms)},
                 {"most_m", std::move(most)}});
  return result;
}

}  // namespace

json to_json(const Outcome& outcome) {
  return std::visit([](const auto& result) { return of(result); }, outcome);
}

}  // namespace clothlab::lab
