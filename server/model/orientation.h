// On which side of a plane or a line a point lies, without rounding: the sign of a determinant. First in
// floating point with a bound of its error, then exactly. Follows Shewchuk 1997, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates".
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace clothlab::model {

using glm::dvec3;

/// The sign, 1, -1 or 0, of dot(cross(b - a, c - a), d - a): which side of the plane a b c has d. Exact for
/// finite coordinates whose products neither overflow nor underflow.
int side(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d);

/// Two coordinate axes that a figure is projected on.
using Projection = std::array<int, 2>;
inline constexpr std::array<Projection, 3> projections{{{0, 1}, {1, 2}, {2, 0}}};

/// The sign of the area of the triangle a b c as `on` shows it: 1 if it turns to the left. Exact.
int turn(const dvec3& a, const dvec3& b, const dvec3& c, Projection on);

/// The same where floating point is sure of it, else 0.
int sure_turn(const dvec3& a, const dvec3& b, const dvec3& c, Projection on);

}  // namespace clothlab::model
