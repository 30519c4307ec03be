// The bending of a sheet that is flat at rest: a plate on any triangle mesh, as pairs of vertices
// (shaders/elements/bending.glsl).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/model/bending_pairs.h"
#include "server/model/unfold.h"

namespace clothlab::model {

/// Moment a metre of width over curvature [N m].
struct PlateStiffness {
  double warp = 0, weft = 0, twist = 0;
};

/// The pairs of a plate, each once, in rising order. A pair of two held vertices moves nothing, but without
/// it the sum over all pairs would be no energy: it is negative where the sheet is flat. The plate's is the
/// sum of
///   area / 2 (warp k_ww^2 + weft k_ff^2 + 4 twist k_wf^2)
/// over the triangles, with the curvature k of Morley's element (1968): it follows from the slopes across the
/// middles of a triangle's edges, less those of the triangle itself. The slope at an edge is the mean of its
/// two triangles', corrected by the places of the (up to eight) vertices around so that every quadratic
/// surface has its exact slope, and so its exact curvature and energy. A free edge takes the slope of least
/// energy: no moment. A triangle whose corners are all `held` is a clamp: it bends nothing, and an edge that
/// it shares has its slope.
///
/// `triangles` [triangle_count] index `held` [vertex_count]; `flat` [triangle_count] are their rest shapes,
/// each in its own place in the plane: neighbours are unfolded across their common edge. An edge of more than
/// two triangles passes no moment.
std::vector<BendingPair> bending_pairs(const Triangles& triangles, const std::vector<FlatTriangle>& flat,
                                       const std::vector<char>& held, const PlateStiffness& stiffness);

/// The energy of one triangle of a plate as half the sum of three squares, each of a linear form of the
/// places of the vertices around it: the triangle's own corners first. Unused places repeat the first vertex,
/// with 0 as its share.
struct CurvatureRows {
  static constexpr std::size_t most_vertices = 12;
  std::array<std::uint32_t, most_vertices> vertices{};
  std::array<std::array<double, most_vertices>, 3> row{};  ///< [sqrt(N/m)]
};

/// The same energy as `bending_pairs`, triangle by triangle; clamps are left out.
std::vector<CurvatureRows> curvature_rows(const Triangles& triangles, const std::vector<FlatTriangle>& flat,
                                          const std::vector<char>& held, const PlateStiffness& stiffness);

/// The pairs that have the energy of the rows, each once, in rising order.
std::vector<BendingPair> bending_pairs(const std::vector<CurvatureRows>& triangles);

}  // namespace clothlab::model
