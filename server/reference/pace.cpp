#include "server/reference/pace.h"

#include <algorithm>
#include <cmath>

#include "server/reference/trajectory.h"

namespace clothlab::reference {

namespace {

// RK4 takes a step for each 1 / fastest_rate, whatever moves. The length of Esdirk's steps follows what
// moves: cotton of 25x25 vertices that falls into folds takes 2000 a second for 5e-6 of its size, each as
// dear as about twenty of RK4's (README.md has the figures).
constexpr double stiff_steps_a_second = 2000.0;
constexpr double cost_of_a_stiff_step = 20.0;  // in steps of RK4

}  // namespace

double Pace::step_at(double t) const {
  if (pieces.empty()) return largest_step;
  // A time at the end of a piece, but for rounding, belongs to the next one.
  const auto found = std::upper_bound(pieces.begin(), pieces.end(), t, [](double time, const Piece& piece) {
    return time < piece.until - 1e-6 * piece.step;
  });
  return (found == pieces.end() ? pieces.back() : *found).step;
}

Pace Pace::halved(int halvings) const {
  Pace finer = *this;
  finer.largest_step = std::ldexp(largest_step, -halvings);
  for (Piece& piece : finer.pieces) piece.step = std::ldexp(piece.step, -halvings);
  return finer;
}

Pace::Method cheaper_method(const World& world) {
  const bool stiff = fastest_rate(world) > stiff_steps_a_second * cost_of_a_stiff_step;
  return stiff ? Pace::Method::esdirk : Pace::Method::rk4;
}

}  // namespace clothlab::reference
