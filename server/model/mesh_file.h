// Meshes as files that other programs read: Wavefront OBJ and PLY. Positions are in metres and keep every bit
// of the float.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// An OBJ file of `positions` [vertex_count] [m] with the model's triangles and texture coordinates.
/// `comment` is one line of text.
std::string obj_text(const Model& model, const std::vector<glm::vec3>& positions, const std::string& comment);
/// The same of any triangles, with a texture coordinate for each position.
std::string obj_text(std::span<const std::array<std::uint32_t, 3>> triangles,
                     std::span<const glm::vec2> texture_coordinates, std::span<const glm::vec3> positions,
                     const std::string& comment);

/// A binary little-endian PLY file of the same mesh; `comment` is one line of text.
std::string ply_bytes(const Model& model, const std::vector<glm::vec3>& positions,
                      const std::string& comment);

/// A binary little-endian PLY file of a body's mesh, in the mesh's own frame, as server/net/README.md has it.
std::string ply_bytes(const scene::TriangleMesh& mesh, const std::string& comment);

/// The same of the collider of this name; none: the scene has no such collider, or it is no mesh.
std::optional<std::string> collider_ply(const scene::Scene& scene, const std::string& name);

}  // namespace clothlab::model
