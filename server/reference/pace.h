// How the reference steps a scene: with which method, and how long its steps are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/reference/reference.h"

namespace clothlab::reference {

struct Pace {
  enum class Method : std::uint8_t { rk4, esdirk } method = Method::rk4;
  double largest_step = 0;  ///< [s]

  // Esdirk only.
  /// Steps of `step` [s] from the end of the piece before until `until` [s]; those of the last piece go on.
  struct Piece {
    double until = 0, step = 0;
  };
  std::vector<Piece> pieces = {};
  double precision = 0;  ///< to which the equation of a stage is solved: RMS over the vertices [m]

  /// The length of a step that starts at time t [s].
  double step_at(double t) const;
  /// The same with steps a 2^`halvings`th as long.
  Pace halved(int halvings) const;
};

/// Steps, factors of matrices and solutions with them.
struct EsdirkWork {
  std::uint64_t steps = 0, factors = 0, solves = 0;
};

/// The method that costs less for a scene.
Pace::Method cheaper_method(const World& world);

}  // namespace clothlab::reference
