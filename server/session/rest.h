// Detects that a cloth has come to rest, so that its session may stop stepping until something changes.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::session {

/// A cloth is at rest if during a stretch of time no vertex was farther than `drift` from its place at the
/// beginning of the stretch. The stretch is longer than the slowest swing takes from one turning point to the
/// next. Speeds are no measure: rounding leaves up to 1e-3 m/s in a stiff cloth that goes nowhere. This class
/// computes from given positions only, so that tests need no simulation.
class Rest {
 public:
  /// Sets the limits for a changed scene, and begins to watch anew.
  void follow(const scene::Scene& scene, const model::Model& model);
  /// Begins to watch anew, because something has happened to the cloth.
  void disturb() { begun_.reset(); }

  /// Takes in the simulated time [s] and the largest speed [m/s] of the cloth. Calls `positions` only while
  /// the speed is low, about `most_looks` times per stretch. True: the cloth is at rest.
  bool look(double time, double max_speed, const std::function<std::vector<glm::vec3>()>& positions);

  bool driven() const {
    return driven_;
  }  ///< a pin or a collider moves, or the wind gusts, in the end: never at rest
  double speed() const { return speed_; }      ///< a cloth that moves faster is not at rest [m/s]
  double drift() const { return drift_; }      ///< the distance that a vertex at rest may move [m]
  double stretch() const { return stretch_; }  ///< simulated time [s]
  /// How often positions are compared in a stretch; at least `least_looks`, however fast time runs.
  static constexpr int least_looks = 16, most_looks = 32;

 private:
  void begin(double time, std::vector<glm::vec3> positions);
  bool drifted(const std::vector<glm::vec3>& now) const;

  double keyed_until_ = 0;  ///< from then on no keyed value changes [s]
  bool driven_ = true;
  double speed_ = 0, drift_ = 0, stretch_ = 0;
  std::optional<double> begun_;  ///< beginning of the present stretch [s]
  double next_look_ = 0;         ///< [s]
  int looks_ = 0;                ///< since `begun_`
  std::vector<glm::vec3> then_;  ///< positions at `begun_`: [vertex] [m]
};

}  // namespace clothlab::session
