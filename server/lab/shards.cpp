#include "server/lab/shards.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "server/base/text.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"

namespace clothlab::lab {

namespace {

template <class T>
void append(std::vector<T>& list, std::vector<T>& more) {
  list.insert(list.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// The notes of several parts may be alike.
void append_new(std::vector<std::string>& list, const std::vector<std::string>& more) {
  for (const std::string& words : more)
    if (std::find(list.begin(), list.end(), words) == list.end()) list.push_back(words);
}

void add_renderer(std::string& all, const std::string& renderer) {
  if (all.find(renderer) == std::string::npos) all += "; " + renderer;
}

/// The larger error of two references, which machines of different speed compute with different steps.
void take_larger(std::optional<double>& error, const std::optional<double>& other) {
  if (error && other) error = std::max(*error, *other);
}

void add(Chart& chart, Chart& part) {
  add_renderer(chart.renderer, part.renderer);
  if (part.horizon != chart.horizon)
    append_new(chart.notes, {"The points of " + std::string(scene::name(part.present.method)) + ": " +
                             part.horizon_reason});
  for (std::size_t axis = 0; axis < all_axes.size(); ++axis)
    take_larger(chart.axes[axis].reference_error, part.axes[axis].reference_error);
  append(chart.points, part.points);
  append(chart.left_out, part.left_out);
  append_new(chart.notes, part.notes);
  chart.complete = chart.complete && part.complete;
}

void add(StabilityMap& map, StabilityMap& part) {
  add_renderer(map.renderer, part.renderer);
  map.time = std::max(map.time, part.time);
  map.steps = std::max(map.steps, part.steps);
  append(map.methods, part.methods);
  append_new(map.notes, part.notes);
  map.complete = map.complete && part.complete;
}

/// The scene's own setting is a chart's first point.
bool has_present(const Outcome& part) {
  const Chart* chart = std::get_if<Chart>(&part);
  return chart && !chart->points.empty() && chart->points.front().setting.method == chart->present.method;
}

template <class Kind>
Outcome joined_as(std::vector<Outcome>& parts, std::size_t all) {
  Kind whole = std::get<Kind>(std::move(parts.front()));
  for (std::size_t i = 1; i < parts.size(); ++i) add(whole, std::get<Kind>(parts[i]));
  if (parts.size() < all) {
    whole.complete = false;
    whole.notes.push_back(std::to_string(all - parts.size()) + " of " + std::to_string(all) +
                          " methods are not measured yet.");
  }
  return whole;
}

template <class Request>
std::vector<Job> one_each(const Request& request, const std::vector<scene::Method>& methods) {
  std::vector<Job> jobs;
  for (const scene::Method method : methods) {
    Request one = request;
    one.methods = {method};
    jobs.push_back(one);
  }
  return jobs;
}

}  // namespace

Result<std::vector<Job>> split(const scene::Document& document, const Job& job) {
  const auto* chart = std::get_if<ChartRequest>(&job);
  const auto* map = std::get_if<MapRequest>(&job);
  if (!chart && !map) return Error{"--shard", name(job), "a chart or a stability map"};
  const auto methods = scene::suited_methods(document.scene, chart ? chart->methods : map->methods);
  if (!methods) return methods.error();
  return chart ? one_each(*chart, *methods) : one_each(*map, *methods);
}

Outcome joined(std::vector<Outcome> parts, std::size_t all) {
  std::stable_partition(parts.begin(), parts.end(), has_present);
  if (std::holds_alternative<Chart>(parts.front())) return joined_as<Chart>(parts, all);
  return joined_as<StabilityMap>(parts, all);
}

void leave_out_costs(Chart& chart, const std::string& why) {
  for (Point& point : chart.points) point.cost.reset();
  chart.notes.push_back(why);
}

}  // namespace clothlab::lab
