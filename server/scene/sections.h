// The sections of the scene document, each read and checked in its own file. Internal to server/scene.
#pragma once

#include "server/scene/reader.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

/// `index` gives the default name: "cloth", "cloth-2", ...
Cloth read_cloth(const Reader& cloth, std::size_t index);
Collider read_collider(const Reader& collider, std::size_t index);
/// Of a collider, which has it under the name of its kind.
Shape read_shape(const Reader& collider);
/// The names of kinds that are announced, and not supported yet.
const Words& shapes_to_come();
Motion read_motion(const Reader& motion);

/// Which vertices a pin holds or a weight is at, checked against the mesh they belong to.
At read_at(const Reader& at, const Mesh& mesh);

std::size_t vertex_count(const Mesh& mesh);
std::size_t triangle_count(const Mesh& mesh);

/// "cloth", "cloth-2", ...
std::string default_name(const char* kind, std::size_t index);

}  // namespace clothlab::scene
