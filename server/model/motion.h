// The motion of pins, colliders and the wind as closed forms of time, in double precision. Shared by the GPU
// path and the reference.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "server/scene/scene.h"

namespace clothlab::model {

/// A rigid motion at one time: maps a home position to its present position, and gives the velocity there.
/// (For a pin with a place of its own: from the rest position, and without the velocity of its glide to that
/// place.)
struct Pose {
  glm::dmat3 rotation{1.0};          ///< of a pin with a place: times a share that falls to 0
  glm::dvec3 translation{0.0};       ///< [m]
  glm::dvec3 linear_velocity{0.0};   ///< velocity of the point now at the origin [m/s]
  glm::dvec3 angular_velocity{0.0};  ///< [rad/s]

  glm::dvec3 place(const glm::dvec3& home) const { return rotation * home + translation; }
  glm::dvec3 velocity_at(const glm::dvec3& position) const;
};

/// The pose of `motion` at `time` [s] since the start. `settled`: a pin with a place is there already, and
/// does not glide there from its rest place.
Pose pose(const scene::Motion& motion, double time, bool settled = false);

/// A speed that the point whose home is at `home` never exceeds under `motion` [m/s].
double top_speed(const scene::Motion& motion, const glm::dvec3& home);

/// Velocity of the air [m/s] at `time` [s] since the start.
glm::dvec3 wind_velocity(const scene::Wind& wind, double time);

}  // namespace clothlab::model
