// The bending of a sheet that is curved at rest: a plate's triangles (plate.h), each of whose curvatures is
// measured from the one that it has at rest (shaders/elements/shell.glsl).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/model/plate.h"

namespace clothlab::model {

using glm::dvec3;

/// A vertex that is pulled along the normal of a triangle nearby.
struct Rise {
  std::array<std::uint32_t, 3> triangle{};
  std::uint32_t vertex = 0;
  double pull = 0;        ///< [N], of either sign
  double height = 0;      ///< of the vertex over the triangle at rest [m]
  double twice_area = 0;  ///< of the triangle at rest [m^2]
};

/// A triangle's three forms, which at rest are `along_normal` times its normal, and their energy: half the
/// sum of the squares of their differences from that.
struct CurvedTriangle {
  CurvatureRows rows;
  std::array<double, 3> along_normal{};  ///< [sqrt(N m)]
};

/// The triangles of the plate (see curvature_rows) with the curvatures that `rest` [vertex_count] [m] gives
/// them. The part of a form that at rest lies in the triangle's plane is subtracted, as a form of the
/// triangle's own corners, which turns and stretches with them.
std::vector<CurvedTriangle> curved_triangles(std::vector<CurvatureRows> plate,
                                             const std::vector<dvec3>& rest);

/// What the triangles' energy has beside that of the pairs made from their rows: the sum over all rises of
///   pull (rest height / 2 - height).
std::vector<Rise> rises(const std::vector<CurvedTriangle>& triangles, const std::vector<dvec3>& rest);

}  // namespace clothlab::model
