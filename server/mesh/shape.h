// What a mesh's use is guessed from when somebody opens its file: its areas, its edges, its openings, its
// top.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/mesh/mesh.h"

namespace clothlab::mesh {

struct Shape {
  double area = 0;          ///< of the triangles [m^2]
  double pattern_area = 0;  ///< of the texture coordinates; 0: there are none
  double mean_edge = 0;     ///< length of an edge [m]
  /// Edges of one triangle that follow each other all round a hole or the outline: vertices of the mesh in
  /// order. The longest first.
  std::vector<std::vector<std::uint32_t>> borders;
  /// Along x, y and z: the vertices of the last 3 % of the mesh's extent, rising.
  std::array<std::vector<std::uint32_t>, 3> ends;
};

Shape shape_of(const Mesh& mesh);

/// At most `most` of them, evenly chosen.
std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& vertices, std::size_t most);

}  // namespace clothlab::mesh
