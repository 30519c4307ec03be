// Reads results of the lab from their JSON. Within this file JSON that to_json would not write causes an
// exception; from_json turns it into an Error.
#include <algorithm>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

/// Null stands for a number that was not finite and is read as NaN. (An infinite step limit: see `variant`.)
double number(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

std::optional<double> maybe(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

scene::Method method(const json& value) {
  const std::optional<scene::Method> method = scene::method_of(value.get<std::string>());
  if (!method) throw std::invalid_argument("unknown method " + value.dump());
  return *method;
}

/// Fields that the method does not use are null and keep a Setting's defaults.
Setting setting(const json& value) {
  Setting setting;
  setting.method = method(value.at("method"));
  setting.dt = number(value.at("dt_s"));
  if (!value.at("iterations").is_null()) setting.iterations = value.at("iterations").get<int>();
  if (!value.at("tolerance").is_null()) setting.tolerance = number(value.at("tolerance"));
  return setting;
}

Errors errors(const json& value) {
  Errors errors;
  for (const Axis axis : all_axes) errors[static_cast<std::size_t>(axis)] = maybe(value.at(name(axis)));
  return errors;
}

std::optional<Cost> cost(const json& value) {
  if (value.is_null()) return std::nullopt;
  Cost cost{number(value.at("median")), number(value.at("minimum")), value.at("runs").get<int>()};
  if (!value.at("high").is_null()) {
    cost.low = number(value.at("low"));
    cost.high = number(value.at("high"));
  }
  return cost;
}

Point point(const json& value) {
  Point point;
  point.setting = setting(value);
  point.error = errors(value.at("error"));
  point.largest_position_error = maybe(value.at("largest_position_error"));
  point.error_low = maybe(value.at("largest_position_error_low"));
  point.error_high = maybe(value.at("largest_position_error_high"));
  point.cost = cost(value.at("ms_a_simulated_s"));
  point.blew_up_at = maybe(value.at("blew_up_at_s"));
  if (const json& of = value.at("convergence"); !of.is_null()) {
    point.residual = maybe(of.at("residual"));
    point.step_error = maybe(of.at("error_m"));
  }
  point.dt_over_limit = maybe(value.at("dt_over_limit"));
  return point;
}

template <class Item>
std::vector<Item> list(const json& value, Item (*read)(const json&)) {
  if (!value.is_array()) throw std::invalid_argument("expected a list");
  std::vector<Item> items;
  for (const json& item : value) items.push_back(read(item));
  return items;
}

std::vector<std::string> texts(const json& value) {
  return value.get<std::vector<std::string>>();
}

LeftOut left_out(const json& value) {
  LeftOut left_out{method(value.at("method")), maybe(value.at("dt_s")), std::nullopt, value.at("reason")};
  if (!value.at("iterations").is_null()) left_out.iterations = value.at("iterations").get<int>();
  return left_out;
}

/// Reads the members that every result of the lab starts with.
template <class Result>
void read_heading(Result& result, const json& value) {
  result.scene = value.at("scene");
  result.renderer = value.at("renderer");
  result.origin = {value.at("scene_hash"), value.at("date")};
  result.time = number(value.at("time_s"));
  result.complete = value.at("complete").get<bool>();
  result.notes = texts(value.at("notes"));
}

Chart chart(const json& value) {
  Chart chart;
  read_heading(chart, value);
  chart.size = number(value.at("size_m"));
  chart.horizon = number(value.at("horizon_s"));
  chart.horizon_reason = value.at("horizon_reason");
  chart.present = setting(value.at("present"));
  for (const Axis axis : all_axes) {
    const json& facts = value.at("axes").at(name(axis));
    chart.axes[static_cast<std::size_t>(axis)] = {facts.at("available").get<bool>(), facts.at("reason"),
                                                  maybe(facts.at("reference_error")),
                                                  maybe(facts.at("float32_floor"))};
  }
  chart.points = list(value.at("points"), point);
  chart.left_out = list(value.at("left_out"), left_out);
  return chart;
}

MapCell cell(const json& value) {
  return {number(value.at("dt_s")), number(value.at("growth")), value.at("blew_up").get<bool>()};
}

MapColumn column(const json& value) {
  return {number(value.at("value")),    maybe(value.at("theory_s")),       maybe(value.at("held_s")),
          maybe(value.at("failed_s")),  value.at("disagrees").get<bool>(), value.at("reason"),
          list(value.at("cells"), cell)};
}

MethodMap method_map(const json& value) {
  return {method(value.at("method")), list(value.at("columns"), column)};
}

StabilityMap stability(const json& value) {
  StabilityMap map;
  read_heading(map, value);
  map.field = value.at("field");
  map.unit = value.at("unit");
  map.present_value = number(value.at("present").at("value"));
  map.present_dt = number(value.at("present").at("dt_s"));
  map.present_method = method(value.at("present").at("method"));
  map.steps = value.at("steps").get<int>();
  map.methods = list(value.at("methods"), method_map);
  return map;
}

Choice choice(const json& value) {
  Choice choice;
  read_heading(choice, value);
  choice.tolerance = number(value.at("tolerance"));
  choice.horizon = number(value.at("horizon_s"));
  choice.asked = number(value.at("asked_s"));
  choice.horizon_reason = value.at("horizon_reason");
  choice.reference_error = number(value.at("reference_error"));
  choice.met = value.at("met").get<bool>();
  choice.chosen = point(value.at("chosen"));
  if (!value.at("runner_up").is_null()) choice.runner_up = point(value.at("runner_up"));
  choice.present = point(value.at("present"));
  choice.why = value.at("why");
  choice.tried = list(value.at("tried"), point);
  return choice;
}

Saving saving_of(const json& value) {
  if (value.is_null()) return Saving::unknown;
  for (const Saving saving : {Saving::yes, Saving::no, Saving::cannot_tell})
    if (value == name(saving)) return saving;
  throw std::invalid_argument("unknown saving " + value.dump());
}

Variant variant(const json& value) {
  Variant variant;
  variant.name = value.at("name");
  variant.patch = value.at("patch");
  variant.measured = value.at("measured").get<bool>();
  variant.reason = value.at("reason");
  variant.error = errors(value.at("error"));
  variant.change = maybe(value.at("change"));
  variant.cost = cost(value.at("ms_a_simulated_s"));
  variant.cost_ratio.median = maybe(value.at("cost_ratio")).value_or(1.0);
  if (!value.at("cost_ratio_low").is_null())
    variant.cost_ratio = {variant.cost_ratio.median, number(value.at("cost_ratio_low")),
                          number(value.at("cost_ratio_high"))};
  variant.saving = saving_of(value.at("saves"));
  variant.dt_limit = maybe(value.at("dt_limit_s")).value_or(std::numeric_limits<double>::infinity());
  variant.recommended_to_drop = value.at("drop").get<bool>();
  return variant;
}

Simplification simplification(const json& value) {
  Simplification simplification;
  read_heading(simplification, value);
  simplification.tolerance = number(value.at("tolerance"));
  simplification.horizon = number(value.at("horizon_s"));
  simplification.size = number(value.at("size_m"));
  simplification.setting = setting(value.at("setting"));
  simplification.whole = variant(value.at("whole"));
  simplification.variants = list(value.at("variants"), variant);
  simplification.recommended = variant(value.at("recommended"));
  simplification.why = value.at("why");
  return simplification;
}

Outcome any(const json& value) {
  const std::string kind = value.at("kind");
  if (kind == "chart") return chart(value);
  if (kind == "stability") return stability(value);
  if (kind == "choose") return choice(value);
  if (kind == "simplify") return simplification(value);
  throw std::invalid_argument("unknown kind " + kind);
}

}  // namespace

Result<Outcome> from_json(const json& value) {
  try {
    return any(value);
  } catch (const std::exception& problem) {  // thrown by nlohmann's library or by this file
    return Error{"result of the lab", problem.what(), "what this version of the program wrote"};
  }
}

}  // namespace clothlab::lab
