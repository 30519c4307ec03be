// The number of a scene that a stability map varies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

/// All stiffnesses of all cloths times a factor, or one number of the scene by its JSON Pointer.
class MapField {
 public:
  /// Error: no such place, no number there, or a number that a map cannot have for an axis.
  static Result<MapField> find(const scene::Document& document, const std::string& field);

  /// The scene with that value; where only whole numbers are allowed `value` becomes the nearest. Error: the
  /// validator's.
  Result<scene::Document> with(double& value) const;

  /// `columns` values from `from` to `to`, rising, each allowed in the scene and different from the others.
  /// Without ends: a hundredth to a hundred times the present value, or as far as the scene allows, a quarter
  /// to four times where only whole numbers are allowed; for one below 0, twice the present value to 0.
  /// Evenly spaced in the logarithm where `from` is above 0. Error: what is wrong with the range.
  Result<std::vector<double>> values(std::optional<double> from, std::optional<double> to, int columns) const;

  double present() const { return present_; }
  std::string unit() const;

 private:
  MapField(const scene::Document& document, std::string field) : document_(document), field_(field) {}
  bool allowed(double value) const;
  /// The value nearest to `end` on the way from the present one that the scene allows.
  double nearest_allowed(double end) const;

  scene::Document document_;
  std::string field_;
  double present_ = 1.0;
  bool whole_ = false;  ///< only whole numbers are allowed
};

}  // namespace clothlab::lab
