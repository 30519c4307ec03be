// What the search for contact between surfaces knows of a scene's triangles before any step
// (surface_pairs.h): their order by place, who owns which vertex and edge, and what can meet among
// neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

#include "server/model/model.h"

namespace clothlab::sim {

/// Triangles of a leaf: those that lie together at the start, whose box stands for all of them in a search.
inline constexpr std::uint32_t leaf_size = 16;
/// The same of a bundle, a part of a leaf.
inline constexpr std::uint32_t bundle_size = 4;
/// Leaves of a bough: a search passes over far ones as a whole.
inline constexpr std::uint32_t bough_size = 64;

/// Near triangles of a cloth are side by side at rest if their middles are this far out of each other's
/// plane, or less, as a share of their distance.
inline constexpr double out_of_plane = 0.35;

/// A vertex of a body, or a corner of the bounds of a block of its triangles. The state's buffers hold them
/// after the cloths' vertices, in this order; shaders/surface/bodies.comp places them.
struct BodyPlace {
  model::dvec3 home;       ///< at time 0 [m]
  std::uint32_t body = 0;  ///< index into Model::bodies
};

/// Triangles of cloths, and after them those of bodies. Each `leaf_size` in turn are a leaf, each
/// `bundle_size` a bundle. Of a box each edge is a triangle without area, from a corner to the other one
/// twice: what cloth meets of a box is its corners and edges, as a solid keeps vertices out of it.
struct SurfaceTriangles {
  /// The corners of each triangle: a vertex, with owns_vertex_bit and owns_edge_bit of
  /// shaders/surface/triangles.glsl where the triangle owns it, or the edge from it to the next corner; and
  /// 0.
  std::vector<std::array<std::uint32_t, 4>> triangles;
  std::uint32_t cloth_triangle_count = 0;
  std::vector<BodyPlace> body_places;
  /// The vertices of each block (surface_blocks.h): of triangles of cloths, and then, for those of bodies,
  /// which are rigid, the corners of their bounds.
  std::vector<std::vector<std::uint32_t>> blocks;
  std::uint32_t cloth_block_count = 0;
  /// For each triangle at rest the middle of its box, and its cloth, or -1 for a body's; its normal, and its
  /// radius about the middle [m].
  std::vector<glm::vec4> rest_places;
  /// Pairs of a vertex and a triangle, and of two edges, that two triangles of a cloth with a common vertex
  /// own and that themselves have none, as in shaders/surface/surface.glsl: edges_bit, no_force_bit.
  std::vector<std::array<std::uint32_t, 4>> neighbour_pairs;

  static std::uint32_t number_of(std::uint32_t corner) { return corner & 0x3fffffffu; }
};

/// `most_blocks`: largest number of blocks, at least twice the colliders that a scene may have.
SurfaceTriangles surface_triangles(const model::Model& model, std::uint32_t most_blocks);

}  // namespace clothlab::sim
