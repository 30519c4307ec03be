// The cloths as a glTF 2.0 file, which renderers and modelling programs read (Khronos Group, glTF 2.0
// specification).
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// A binary glTF file (.glb): a node for each cloth of `scene`, by its name, with its colour on both sides,
/// smooth normals and texture coordinates. `positions` [vertex_count] [m] keep every bit; glTF's unit is the
/// metre, and its y axis points upwards, too. `comment` is one line of text.
std::string glb_bytes(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& positions,
                      const std::string& comment);

}  // namespace clothlab::model
