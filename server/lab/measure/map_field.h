// The number of a scene that a stability map varies: its horizontal axis.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

/// Either one number of the scene, named by its JSON Pointer, or "stiffness": a factor on all stiffnesses of
/// all cloths.
class MapField {
 public:
  /// Error: `field` names nothing in the scene, no number, or a number that cannot be the map's axis (dt, the
  /// document's version).
  static Result<MapField> find(const scene::Document& document, const std::string& field);

  /// The scene with the field set to `value`, which is first rounded where only whole numbers are allowed.
  /// Error: why the scene does not allow the value.
  Result<scene::Document> with(double& value) const;

  /// The map's columns: `columns` rising values from `from` to `to` (fewer where whole numbers coincide),
  /// evenly spaced, in the logarithm where `from` is above 0. Default range, as far as the scene allows: a
  /// hundredth to a hundred times the present value; a quarter to four times where only whole numbers are
  /// allowed; twice the present value to 0 where that value is negative. Error: what is wrong with the range.
  Result<std::vector<double>> values(std::optional<double> from, std::optional<double> to, int columns) const;

  double present() const { return present_; }
  std::string unit() const;

 private:
  MapField(const scene::Document& document, std::string field)
      : document_(document), field_(std::move(field)) {}
  bool allowed(double value) const;
  /// The allowed value nearest to `end`, searched between the present value and `end`.
  double nearest_allowed(double end) const;

  scene::Document document_;
  std::string field_;
  double present_ = 1.0;
  bool whole_ = false;  ///< only whole numbers are allowed
};

}  // namespace clothlab::lab
