#include "server/lab/measure/stability_map.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/disagreement.h"
#include "server/lab/measure/map_column.h"
#include "server/lab/measure/map_field.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"

namespace clothlab::lab {

namespace {

using scene::Method;

/// The columns' range of values: "0.01", or "0.01 to 3.2".
std::string span(const std::vector<const MeasuredColumn*>& columns) {
  const std::string first = with_significant_digits(columns.front()->column.value, 3);
  return columns.size() == 1 ? first
                             : first + " to " + with_significant_digits(columns.back()->column.value, 3);
}

/// The measured limit over theory's, smallest to largest: "0.9 to 0.95 times theory's".
std::string ratio(const std::vector<const MeasuredColumn*>& columns) {
  double least = model::no_limit, most = 0.0;
  for (const MeasuredColumn* column : columns) {
    const double share = *measured_boundary(column->column) / *column->column.theory;
    least = std::min(least, share);
    most = std::max(most, share);
  }
  return with_significant_digits(least, 3) +
         (with_significant_digits(most, 3) == with_significant_digits(least, 3)
              ? ""
              : " to " + with_significant_digits(most, 3)) +
         " times theory's";
}

/// A sentence about neighbouring columns that disagree for the same reason.
std::string disagreement(const StabilityMap& map, Method method,
                         const std::vector<const MeasuredColumn*>& columns) {
  const MapColumn& first = columns.front()->column;
  std::string text = std::string(scene::name(method)) + ", " + map.field + " " + span(columns) + ": ";
  if (!first.theory)
    text += "no step should be unstable, but " + with_significant_digits(*first.failed, 3) + " s failed";
  else if (*first.theory == 0.0)
    text += "theory allows no step at all, yet steps up to " +
            with_significant_digits(first.held.value_or(0.0), 3) + " s held";
  else
    text += "the measured limit is " + ratio(columns);
  text += std::string("; ") + phrase(columns.front()->cause);
  return text + " (at " + with_significant_digits(first.value, 3) + ": " + first.reason + ").";
}

/// Collects the map's notes, method by method.
class Notes {
 public:
  void add(const StabilityMap& map, Method method, const std::vector<MeasuredColumn>& columns) {
    std::vector<const MeasuredColumn*> alike;
    const auto flush = [&] {
      if (!alike.empty()) disagreements_.push_back(disagreement(map, method, alike));
      alike.clear();
    };
    for (const MeasuredColumn& column : columns) {
      if (!alike.empty() && alike.back()->cause != column.cause) flush();
      if (column.column.disagrees) alike.push_back(&column);
      if (column.held_beyond)
        others_.push_back(std::string(scene::name(method)) + ", " + map.field + " " +
                          with_significant_digits(column.column.value, 3) +
                          ": some steps longer than the shortest that failed (" +
                          with_significant_digits(*column.column.failed, 3) +
                          " s) held; the boundary shown is the lower end.");
    }
    flush();
    if (std::all_of(columns.begin(), columns.end(),
                    [](const MeasuredColumn& c) { return !c.column.theory && !c.column.failed; }) &&
        !columns.empty())
      unlimited_ += (unlimited_.empty() ? "" : ", ") + std::string(scene::name(method));
  }

  std::vector<std::string> all(const StabilityMap& map) const {
    std::vector<std::string> notes = disagreements_;
    notes.insert(notes.end(), others_.begin(), others_.end());
    if (!unlimited_.empty())
      notes.push_back(
          "Nothing failed up to 0.1 s with " + unlimited_ +
          ", as theory has it: no step makes them unstable. That says nothing of how right they are.");
    notes.push_back("A trial runs " + std::to_string(map.steps) + " steps at most, " +
                    with_significant_digits(map.time, 3) +
                    " s at most; a vibration that grows too slowly to show in that time counts as stable.");
    return notes;
  }

 private:
  std::vector<std::string> disagreements_, others_;
  std::string unlimited_;
};

/// The scene with the varied number set to `value`.
struct Varied {
  double value = 0;
  scene::Scene scene;
};

/// The scenes of the map's columns; fills in the map's field, unit and present value.
Result<std::vector<Varied>> varied(const scene::Document& document, const MapRequest& request,
                                   StabilityMap& map) {
  const Result<MapField> field = MapField::find(document, request.field);
  if (!field) return field.error();
  map.field = request.field;
  map.unit = field->unit();
  map.present_value = field->present();
  const Result<std::vector<double>> values = field->values(request.from, request.to, request.columns);
  if (!values) return values.error();
  std::vector<Varied> scenes;
  for (double value : *values) {
    const Result<scene::Document> scene = field->with(value);
    if (!scene) return scene.error();
    scenes.push_back({value, scene->scene});
  }
  return scenes;
}

}  // namespace

Result<StabilityMap> stability_map(const scene::Document& document, const MapRequest& request,
                                   const Control<StabilityMap>& control) {
  StabilityMap map;
  map.scene = document.scene.name;
  map.renderer = gl::renderer_name();
  map.present_dt = document.scene.solver.dt;
  map.present_method = document.scene.solver.method;
  const Result<std::vector<Varied>> columns = varied(document, request, map);
  if (!columns) return columns.error();
  const Result<std::vector<Method>> methods = scene::suited_methods(document.scene, request.methods);
  if (!methods) return methods.error();
  const double total = static_cast<double>(methods->size() * columns->size());
  double done = 0.0;
  Notes notes;
  for (const Method method : *methods) {
    map.methods.push_back({method, {}});
    std::vector<MeasuredColumn> measured;
    ReusedSimulation full, bare;
    for (const Varied& column : *columns) {
      scene::Scene scene = column.scene;
      scene.solver.method = method;
      const auto at_trial = [&](double dt, double share) {
        control.progress({done + share, total,
                          text(Setting{method, dt, scene.solver.iterations}) + ", " + map.field + " " +
                              with_significant_digits(column.value, 3)});
      };
      Result<MeasuredColumn> found = measure_column(scene, column.value, full, bare, control.stop, at_trial);
      if (!found) return found.error();
      map.time = std::max(map.time, found->time);
      map.steps = std::max(map.steps, found->steps);
      map.methods.back().columns.push_back(found->column);
      measured.push_back(std::move(*found));
      done += 1.0;
      control.arrived(map);
    }
    notes.add(map, method, measured);
    map.notes = notes.all(map);
  }
  map.complete = true;
  control.progress({total, total, "done"});
  return map;
}

}  // namespace clothlab::lab
