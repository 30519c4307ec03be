// What a sweep measures: a scene, axes along which it varies, and quantities. Each combination of one value
// of every axis is a point.
#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/document.h"

namespace clothlab::sweep {

using nlohmann::json;

/// One value of an axis: what it is called in tables, and what it changes.
struct Value {
  json label;  ///< a number, a text, true, false or null
  json patch;  ///< RFC 7396 merge patch of the scene; null where the axis has `at`
};

struct Axis {
  std::string name;
  std::vector<std::string> at;  ///< JSON Pointers: every place that gets the value; empty: values are patches
  std::vector<Value> values;
};

/// Quantities that cost something to measure. The others (largest strain and speed, energies, blow-up) are
/// always measured.
struct Quantities {
  bool error = false;      ///< against the double-precision reference
  bool cost = false;       ///< time of stepping
  bool crossings = false;  ///< where cloth passes through cloth, in double precision
  bool shape = false;      ///< the mesh at the end, as a file
};

struct Plan {
  std::string name;
  scene::Document base;
  std::vector<Axis> axes;
  Quantities quantities;
  double time = 1.0;     ///< simulated [s]
  double every = 0.05;   ///< simulated time between two looks at the state [s]
  double budget = 60.0;  ///< wall time for the reference of one scene [s]
  json file;             ///< as the user wrote it, with the name and the scene in it: for the sweep's folder

  /// The number of points.
  std::size_t size() const;
  /// The index of the point's value on each axis. The last axis varies fastest.
  std::vector<std::size_t> places(std::size_t point) const;
  /// {axis: label} of a point.
  json labels(std::size_t point) const;
  /// The point's scene. Error: the values make no valid scene.
  Result<scene::Document> scene(std::size_t point) const;
  /// The point's name: 32 hexadecimal digits from all that its result depends on besides the program and the
  /// device, which are the base scene with its meshes, what the values change, the quantities and the times.
  std::string id(std::size_t point) const;

  std::string common;  ///< what all ids begin from
};

/// The most points of one sweep, and the most values of one axis.
inline constexpr std::size_t most_points = 10'000'000, most_values = 100'000;

/// Reads the file of a sweep (JSON, comments allowed). `meshes`: where the meshes are that its scenes name.
/// Error: a JSON Pointer into the file, what is there, what is allowed; or a place that no scene has.
Result<Plan> read_plan(const std::string& path, const std::shared_ptr<const scene::Assets>& meshes);

}  // namespace clothlab::sweep
