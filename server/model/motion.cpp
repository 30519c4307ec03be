#include "server/model/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <type_traits>

namespace clothlab::model {

namespace {

using glm::dmat3;
using glm::dvec3;

/// Rodrigues' formula: the rotation by `angle` [rad] about a unit axis.
dmat3 rotation_about(const dvec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  dmat3 turned;
  for (int column = 0; column < 3; ++column) {
    dvec3 unit(0.0);
    unit[column] = 1.0;
    turned[column] = c * unit + s * glm::cross(axis, unit) + (1.0 - c) * glm::dot(axis, unit) * axis;
  }
  return turned;
}

Pose pose_of(std::monostate, double) {
  return {};
}

Pose pose_of(const scene::Oscillate& motion, double time) {
  const double omega = 2.0 * std::numbers::pi * motion.frequency;
  Pose pose;
  pose.translation = motion.amplitude * std::sin(omega * time) * motion.axis;
  pose.linear_velocity = motion.amplitude * omega * std::cos(omega * time) * motion.axis;
  return pose;
}

Pose pose_of(const scene::Linear& motion, double time) {
  Pose pose;
  pose.translation = motion.velocity * time;
  pose.linear_velocity = motion.velocity;
  return pose;
}

Pose pose_of(const scene::Spin& motion, double time) {
  const double rate = motion.degrees_per_second * std::numbers::pi / 180.0;
  Pose pose;
  pose.rotation = rotation_about(motion.axis, rate * time);
  pose.translation = motion.center - pose.rotation * motion.center;
  pose.angular_velocity = rate * motion.axis;
  pose.linear_velocity = -glm::cross(pose.angular_velocity, motion.center);
  return pose;
}

Pose pose_of(const scene::Placed& pin, double time, bool settled) {
  Pose pose = std::visit([time](const auto& kind) { return pose_of(kind, time); }, pin.then);
  const double share = settled ? 1.0 : std::clamp(time / scene::Placed::glide, 0.0, 1.0);
  const double there = share * share * (3.0 - 2.0 * share);  // begins and ends at rest
  pose.translation += there * (pose.rotation * pin.place);
  pose.rotation *= 1.0 - there;
  return pose;
}

double top_speed_of(std::monostate, const dvec3&) {
  return 0.0;
}

double top_speed_of(const scene::Oscillate& motion, const dvec3&) {
  return std::abs(2.0 * std::numbers::pi * motion.frequency * motion.amplitude);
}

double top_speed_of(const scene::Linear& motion, const dvec3&) {
  return glm::length(motion.velocity);
}

double top_speed_of(const scene::Spin& motion, const dvec3& home) {
  const double rate = motion.degrees_per_second * std::numbers::pi / 180.0;
  return std::abs(rate) * glm::length(glm::cross(motion.axis, home - motion.center));
}

double top_speed_of(const scene::Placed& pin, const dvec3& home) {
  const double glide = 1.5 / scene::Placed::glide * glm::distance(pin.place, home);
  // On its way it is between `home` and `place`, and no farther from an axis than the farther one of them.
  return glide + std::visit(
                     [&](const auto& kind) {
                       return std::max(top_speed_of(kind, home), top_speed_of(kind, pin.place));
                     },
                     pin.then);
}

}  // namespace

double top_speed(const scene::Motion& motion, const dvec3& home) {
  return std::visit([&](const auto& kind) { return top_speed_of(kind, home); }, motion);
}

dvec3 Pose::velocity_at(const dvec3& position) const {
  return linear_velocity + glm::cross(angular_velocity, position);
}

Pose pose(const scene::Motion& motion, double time, bool settled) {
  if (const auto* placed = std::get_if<scene::Placed>(&motion)) return pose_of(*placed, time, settled);
  return std::visit(
      [time](const auto& kind) {
        if constexpr (std::is_same_v<std::decay_t<decltype(kind)>, scene::Placed>)
          return Pose{};
        else
          return pose_of(kind, time);
      },
      motion);
}

dvec3 wind_velocity(const scene::Wind& wind, double time) {
  return wind.velocity * (1.0 + wind.gust * std::sin(2.0 * std::numbers::pi * wind.gust_frequency * time));
}

}  // namespace clothlab::model
