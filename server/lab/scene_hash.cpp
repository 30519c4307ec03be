#include "server/lab/scene_hash.h"

#include <variant>

#include "server/scene/named_fabric.h"

namespace clothlab::lab {

using nlohmann::json;

namespace {

/// The scene without what does not change the motion: names, colours and textures.
json without_appearance(json scene) {
  scene.erase("name");
  for (json& cloth : scene["cloths"])
    for (const char* key : {"name", "color", "texture"}) cloth.erase(key);
  for (json& collider : scene["colliders"]) collider.erase("name");
  return scene;
}

/// What the document does not contain: the meshes that it names.
void add_named_meshes(Hash& hash, const scene::Scene& scene) {
  const auto add = [&](const auto& list) {
    hash.add(std::string(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(list[0])));
  };
  for (const scene::Cloth& cloth : scene.cloths) {
    const auto* mesh = std::get_if<scene::TriangleMesh>(&cloth.mesh);
    if (!mesh || mesh->vertex_of.empty()) continue;
    add(mesh->vertices);
    add(mesh->triangles);
    add(mesh->pattern);
  }
  for (const scene::Collider& collider : scene.colliders) {
    const auto* body = std::get_if<scene::Body>(&collider.shape);
    if (!body) continue;
    add(body->mesh->vertices);
    add(body->mesh->triangles);
  }
}

}  // namespace

void add_scene(Hash& hash, const scene::Document& document) {
  hash.add(without_appearance(scene::spelled_out(document)).dump());
  add_named_meshes(hash, document.scene);
}

}  // namespace clothlab::lab
