#include "server/lab/measure/horizon.h"

#include <algorithm>
#include <random>

#include "server/base/text.h"
#include "server/reference/trajectory.h"

namespace clothlab::lab {

namespace {

constexpr double perturbation = 1e-7;  // of the copy's start, RMS over the size
/// The horizon is where the perturbation has grown by this factor. There chaos alone turns an error of 1e-4
/// into one of 1e-2.
constexpr double growth_by_chaos = 100.0;
constexpr int fewest_looks_to_horizon = 4;  // to the horizon

reference::State perturbed_start(const reference::World& world, double size) {
  reference::State state = reference::at_rest(world);
  std::mt19937 random(1);
  const auto next = [&] { return 2.0 * static_cast<double>(random()) / 4294967296.0 - 1.0; };
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const glm::dvec3 push(next(), next(), next());
    if (!world.pinned(i)) state.position[i] += perturbation * size * push;  // RMS length of `push`: 1
  }
  return state;
}

}  // namespace

Horizon::Horizon(const reference::World& world, double size)
    : copy_(perturbed_start(world, size)),
      begun_(reference::rms_distance(copy_.position, reference::at_rest(world).position)) {}

bool Horizon::look(const reference::State& motion, double time) {
  most_ = std::max(most_, reference::rms_distance(motion.position, copy_.position) / begun_);
  if (most_ > growth_by_chaos) return false;
  time_ = time;
  amplified_ = most_;
  return true;
}

double Horizon::time(double whole) const {
  return time_ < fewest_looks_to_horizon * whole / looks_for_horizon ? 0.0 : time_;
}

std::string Horizon::reason(double whole) const {
  const std::string copy =
      "a copy that starts " + with_significant_digits(perturbation, 3) + " of the size away";
  if (time(whole) == 0.0)
    return "The motion is chaotic at once: " + copy + " is more than " +
           with_significant_digits(growth_by_chaos, 3) + " times as far away after " +
           with_significant_digits(fewest_looks_to_horizon * whole / looks_for_horizon, 3) + " s.";
  if (time_ < whole)
    return "Positions are compared at " + with_significant_digits(time_, 3) + " s: " + copy + " is up to " +
           with_significant_digits(amplified_, 3) + " times as far away until then, and over " +
           with_significant_digits(growth_by_chaos, 3) + " times soon after.";
  return "Positions are compared at " + with_significant_digits(time_, 3) + " s, the whole time: " + copy +
         (most_ < 1.5 ? " stays as near."
                      : " comes no more than " + with_significant_digits(most_, 3) + " times as far away.");
}

}  // namespace clothlab::lab
