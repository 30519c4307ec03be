// Places where borders of a mesh lie together and are not joined. Internal to server/mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/mesh/sides.h"

namespace clothlab::mesh {

struct OpenPlaces {
  struct Place {
    std::uint32_t triangle = 0, other = 0;  ///< the two that meet there
    double gap = 0;                         ///< [m]
  };
  std::size_t corners = 0;   ///< vertices at the place of another one
  double widest = 0;         ///< the largest of their gaps [m]
  std::size_t on_edges = 0;  ///< vertices on the inside of an edge
  Place corner, on_edge;     ///< the first of each
};

/// Looks along the borders, the edges of one triangle alone. Near is less than a thousandth of the sides
/// there. `sides`: those of `triangles`.
OpenPlaces open_places(const std::vector<glm::dvec3>& vertices,
                       const std::vector<std::array<std::uint32_t, 3>>& triangles,
                       const std::vector<Side>& sides);

/// A corner on the inside of an edge of a triangle that has no vertex there.
struct CornerOnEdge {
  std::uint32_t triangle = 0, vertex = 0;
  std::uint32_t from = 0, to = 0;  ///< the edge's ends
  double share = 0;                ///< of the way from `from` to `to`
};
/// All of them that are no farther than `reach` [m] from the edge, by triangle; of very many the first.
std::vector<CornerOnEdge> corners_on_edges(const std::vector<glm::dvec3>& vertices,
                                           const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                           const std::vector<Side>& sides, double reach);

/// What to tell a person of them, a sentence each; none if there are none. `place_of` says where a triangle
/// is.
std::vector<std::string> notes_of(const OpenPlaces& open,
                                  const std::function<std::string(std::size_t triangle)>& place_of);

}  // namespace clothlab::mesh
