// Stiffnesses for the springs of a triangle mesh that make it act as the same sheet however it is cut into
// triangles: an isotropic one, whose contraction is a third of its stretch, as far as springs can.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/model/elements.h"

namespace clothlab::model {

/// What the springs together stand for. Under a uniform strain e the sheet's tension is
///   modulus (2 e + trace(e) I) [N/m].
struct SpringSheet {
  double modulus = 0;  ///< [N/m]
  /// The part of it that the springs across edges carry, which resist folds: 0 to `modulus` [N/m].
  double across = 0;
};

/// A pair of vertices that a spring may join.
struct SheetPair {
  std::uint32_t a = 0, b = 0;
  bool across = false;    ///< opposite an edge of two triangles, and no edge itself
  double area = 0;        ///< a third of the triangles at the edge [m^2]
  bool diagonal = false;  ///< across the longest edge of both triangles, like the other diagonal of a square
};

/// A stiffness [N/m] for each pair, 0 or more. Those of edges are never 0, nor those across edges if
/// `sheet.across` is not; if it is, only diagonals get one: others would keep a sheet from folding that bends
/// freely. None is more than 8 times the modulus, however thin a triangle is. `position` [vertex_count],
/// `triangles` [triangle_count].
std::vector<double> sheet_stiffness(const std::vector<dvec3>& position,
                                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                    const std::vector<SheetPair>& pairs, const SpringSheet& sheet);

}  // namespace clothlab::model
