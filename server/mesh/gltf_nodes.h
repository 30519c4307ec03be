// Where the nodes of a glTF file are. Internal to server/mesh.
#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <vector>

#include "server/mesh/gltf_data.h"

namespace clothlab::mesh {

struct GltfNodes {
  std::vector<glm::dmat4> global;  ///< of each node, from its own frame to the world
  std::vector<std::size_t> roots;  ///< nodes without a parent
};
/// Nodes that are their own descendants stay at the origin.
GltfNodes place_nodes(const GltfData& data);

/// The whole numbers of a list that is a member of an object; none if it is absent.
std::vector<std::size_t> indices_in(const nlohmann::json& of, const char* key);

}  // namespace clothlab::mesh
