// Functions that read and check the sections of the scene document. Internal to server/scene.
#pragma once

#include "server/scene/assets.h"
#include "server/scene/fabrics.h"
#include "server/scene/reader.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

/// `index` is the place in the list; the default name follows from it: "cloth", "cloth-2", ... `assets` (may
/// be null) has the meshes that documents name.
Cloth read_cloth(const Reader& cloth, std::size_t index, const Assets* assets);

/// A material, and the fabric that it names, or null.
struct FabricMaterial {
  Material material;
  const Fabric* fabric = nullptr;
};
/// `mesh` and `scale` (of its transform): springs fitted to a fabric depend on the distance of the vertices.
FabricMaterial read_material(const Reader& material, const Mesh& mesh, double scale);
/// A material of finite elements: with the numbers of `fabric` where it has none, or, without one, the
/// standard ones.
Fem read_sheet(const Reader& material, const Fabric* fabric);

Collider read_collider(const Reader& collider, std::size_t index, const Assets* assets);
/// Reads the shape of a collider, which is the member with the name of its kind, e.g. "sphere".
Shape read_shape(const Reader& collider, const Assets* assets);
/// Reads the members `mesh` and `transform` of a collider.
Body read_body(const Reader& collider, const Assets* assets);
Motion read_motion(const Reader& motion);

/// Reads the keys into a scene that is else complete.
void read_keys(const Reader& keys, Scene& scene);

/// The mesh of a panel.
TriangleMesh read_panel(const Reader& panel);
/// The mesh of a cloth.
Mesh read_mesh(const Reader& mesh, const Assets* assets);
Transform read_transform(const Reader& transform);

/// Reads the `at` of a pin or a weight and checks it against the mesh of its cloth.
At read_at(const Reader& at, const Mesh& mesh);

std::size_t vertex_count(const Mesh& mesh);
std::size_t triangle_count(const Mesh& mesh);

/// "cloth", "cloth-2", ...
std::string default_name(const char* kind, std::size_t index);

}  // namespace clothlab::scene
