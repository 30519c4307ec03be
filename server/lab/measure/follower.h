// Advances a reference simulation from one time to another.
#pragma once

#include <cmath>
#include <cstdint>
#include <stop_token>
#include <utility>

#include "server/reference/methods.h"
#include "server/reference/reference.h"

namespace clothlab::lab {

/// Advances states of `world` with RK4, in steps of at most `largest_step` [s], until `stop` is requested.
class Follower {
 public:
  Follower(reference::World world, double largest_step, const std::stop_token& stop)
      : world_(std::move(world)), largest_step_(largest_step), stop_(stop) {}

  reference::World& world() { return world_; }

  /// Advances `state` from time `from` to time `to` [s] in equal steps; false: cancelled.
  bool follow(reference::State& state, double from, double to) {
    const auto steps = static_cast<std::int64_t>(std::ceil((to - from) / largest_step_ - 1e-9));
    const double dt = (to - from) / static_cast<double>(steps);
    world_.scene.solver.dt = dt;
    for (std::int64_t n = 0; n < steps; ++n) {
      if (stop_.stop_requested()) return false;
      const double at = static_cast<double>(n);
      reference::advance(reference::rk4, world_, state, from + at * dt, from + (at + 1) * dt);
    }
    return true;
  }

 private:
  reference::World world_;
  double largest_step_;
  std::stop_token stop_;
};

}  // namespace clothlab::lab
