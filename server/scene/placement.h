// Where the transform of a cloth or a body puts points, and what becomes of it when the body moves.
#pragma once

#include <glm/mat3x3.hpp>
#include <vector>

#include "server/scene/scene.h"

namespace clothlab::scene {

/// The rotation about x, then y, then z [degrees].
glm::dmat3 turn(const dvec3& degrees);

/// The angles [degrees] whose turn() is `axes`. Where y is a right angle, x and z turn alike: z is 0 then.
dvec3 angles(const glm::dmat3& axes);

/// The points [m] scaled, turned and moved.
std::vector<dvec3> placed(const Transform& transform, std::vector<dvec3> points);

/// The transform that does the same, then turns by `rotation`, then moves by `translation` [m].
Transform moved(const Transform& home, const glm::dmat3& rotation, const dvec3& translation);

}  // namespace clothlab::scene
