// Meshes as files that other programs read: Wavefront OBJ and PLY. Positions in metres, to the last bit of
// the float.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// `positions` [vertex_count] with the model's triangles and texture coordinates. `comment` is one line of
/// text.
std::string obj_text(const Model& model, const std::vector<glm::vec3>& positions, const std::string& comment);

/// The same as binary little-endian PLY.
std::string ply_bytes(const Model& model, const std::vector<glm::vec3>& positions,
                      const std::string& comment);

}  // namespace clothlab::model
