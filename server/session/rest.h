// Whether a cloth has come to rest, so that its session may stop stepping until something changes.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::session {

/// Pure arithmetic on what is measured, so that it can be tested without a simulation. At rest: for longer
/// than the slowest swing takes from one turning point to the next, no vertex was further than `drift` from
/// where it was at the beginning of that stretch. Speeds do not tell: what rounding leaves in a stiff cloth
/// is fast, up to 1e-3 m/s, and goes nowhere.
class Rest {
 public:
  /// Another scene, or another state of it: watches anew.
  void follow(const scene::Scene& scene, const model::Model& model);
  /// Watches anew: something has happened.
  void disturb() { begun_.reset(); }

  /// A look at the moving cloth: simulated `time` [s] and the largest speed [m/s]. `positions` is asked for
  /// only while that is small, about `most_looks` times a stretch. True: it is at rest.
  bool look(double time, double max_speed, const std::function<std::vector<glm::vec3>()>& positions);

  bool driven() const { return driven_; }      ///< a pin or a collider moves: never at rest
  double speed() const { return speed_; }      ///< faster than this is not looked at closer [m/s]
  double drift() const { return drift_; }      ///< [m]
  double stretch() const { return stretch_; }  ///< of simulated time [s]
  /// Looks at the positions in a stretch; at least so many, however fast time runs.
  static constexpr int least_looks = 16, most_looks = 32;

 private:
  void begin(double time, std::vector<glm::vec3> positions);
  bool drifted(const std::vector<glm::vec3>& now) const;

  bool driven_ = true;
  double speed_ = 0, drift_ = 0, stretch_ = 0;
  std::optional<double> begun_;  ///< [s]
  double next_look_ = 0;         ///< [s]
  int looks_ = 0;                ///< since `begun`
  std::vector<glm::vec3> then_;  ///< [vertex] [m], at `begun`
};

}  // namespace clothlab::session
