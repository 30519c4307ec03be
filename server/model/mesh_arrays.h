// Triangles and springs of the two kinds of mesh. Internal to model/.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// A spring of a mesh, whose rest length and stiffness are not yet known.
struct MeshSpring {
  std::uint32_t a = 0, b = 0;  ///< vertices, a < b
  SpringKind kind = SpringKind::structural;
};

/// What a mesh contributes, with vertex indices local to its cloth.
struct MeshArrays {
  std::vector<dvec3> position;  ///< before the cloth's transform [m]
  std::vector<glm::vec2> texture_coordinates;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<MeshSpring> springs;  ///< each once
};

/// Springs of a kind whose stiffness is 0 are left out.
MeshArrays grid_arrays(const scene::Grid& grid, const scene::Springs& material);

/// Structural springs along the edges, bend springs between the vertices opposite an inner edge.
MeshArrays triangle_mesh_arrays(const scene::TriangleMesh& mesh, const scene::Springs& material);

}  // namespace clothlab::model
