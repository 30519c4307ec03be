// Where surfaces pass through each other: edges that meet triangles, found in double precision without
// rounding. This is what contact between surfaces is judged by, so it shares nothing with the GPU's search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// True if the segment p q and the triangle a b c have a point in common. Their borders belong to them: what
/// touches exactly meets, and so do a segment in the triangle's plane that overlaps it, a triangle without
/// area that the segment hits, and equal points. Exact for finite coordinates.
bool meets(const dvec3& p, const dvec3& q, const dvec3& a, const dvec3& b, const dvec3& c);

/// Triangles of cloths, and after them those of bodies, over one list of vertices.
struct Surfaces {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< of the triangles, each once, in rising order
  /// Vertices from this one on belong to bodies. Bodies are not compared with each other.
  std::uint32_t first_body_vertex = 0;
  bool among_cloths = true;  ///< false: cloths are compared with bodies alone
};

/// The positions as the GPU gets them.
std::vector<dvec3> as_floats(const std::vector<dvec3>& x);

/// The surfaces of all cloths, and of which bodies.
enum class Bodies { none, meshes, all };
Surfaces surfaces_of(const Model& model, Bodies bodies = Bodies::all);

/// An edge that meets a triangle with which it shares no vertex.
struct Crossing {
  std::array<std::uint32_t, 2> edge;      ///< its vertices
  std::array<std::uint32_t, 3> triangle;  ///< its vertices
  dvec3 place;                            ///< a point of both, rounded [m]
  bool operator==(const Crossing&) const = default;
};

struct Crossings {
  std::uint64_t count = 0;      ///< pairs of an edge and a triangle
  bool complete = true;         ///< false: the search stopped at this count, there may be more
  std::vector<Crossing> first;  ///< the first pairs, in the order of edges, then of triangles
};

/// How many crossings a search names and counts.
struct CrossingLimits {
  std::size_t named = 5;
  std::uint64_t counted = std::numeric_limits<std::uint64_t>::max();
};

/// All crossings of `surfaces` with vertices at `x`, which are finite: those of the cloths, then those of the
/// bodies [m].
Crossings find_crossings(const Surfaces& surfaces, const std::vector<dvec3>& x, CrossingLimits limits = {});

}  // namespace clothlab::model
