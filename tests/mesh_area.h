// The area of a mesh that was read from a file.
#pragma once

#include <glm/geometric.hpp>

#include "server/mesh/mesh.h"

namespace clothlab::test {

/// Of all triangles, in the file's unit squared.
inline double area_of(const mesh::Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += 0.5 *
            glm::length(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  return area;
}

}  // namespace clothlab::test
