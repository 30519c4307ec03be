// Vertices, triangles and springs of the two kinds of mesh: grids and triangle meshes. Internal to model/.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// A spring of a mesh.
struct MeshSpring {
  std::uint32_t a = 0, b = 0;  ///< vertices, a < b
  double stiffness = 0.0;      ///< [N/m]
  double damping = 0.0;        ///< [N s/m]
  double rest = 0.0;  ///< length in the flat pattern, before the cloth's transform [m]; 0: as the mesh has it
};

/// The arrays of one mesh; vertex indices count within its cloth.
struct MeshArrays {
  std::vector<dvec3> position;  ///< before the cloth's transform [m]
  /// [vertex_count], each in [0, 1]: over the width and height of a grid, or over a mesh's largest extent.
  std::vector<glm::vec2> texture_coordinates;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  dvec3 first_axis{1, 0, 0};        ///< the direction in which the first texture coordinate grows
  dvec3 second_axis{0, 0, 1};       ///< the same of the second
  std::vector<MeshSpring> springs;  ///< without duplicates; none for finite elements
};

/// The arrays of a grid. Kinds of springs whose stiffness is 0 are left out.
MeshArrays grid_arrays(const scene::Grid& grid, const scene::Material& material);

/// The arrays of a triangle mesh. Springs join the ends of its edges, and the vertices opposite an edge of
/// two triangles. Together they act like a grid with the same material whose threads run in all directions
/// (sheet_springs.h); rest lengths are those of its pattern if it has one.
MeshArrays triangle_mesh_arrays(const scene::TriangleMesh& mesh, const scene::Material& material);

}  // namespace clothlab::model
