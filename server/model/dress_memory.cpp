#include "server/model/dress_memory.h"

#include <algorithm>
#include <utility>

#include "server/base/hash.h"
#include "server/model/bodies.h"
#include "server/model/skin.h"

namespace clothlab::model {

namespace {

template <class Value>
void add(Hash& hash, const std::vector<Value>& values) {
  hash.add(std::to_string(values.size()) + ":");
  hash.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)});
}

}  // namespace

std::string dress_key(const Model& model, const scene::Scene& scene, const std::vector<std::uint8_t>& led_out,
                      std::size_t steps) {
  Hash hash;
  add(hash, model.start_position);
  add(hash, model.triangles);
  add(hash, model.pin_motion);
  add(hash, model.vertex_cloth);
  add(hash, led_out);
  add(hash, body_positions(model, 0.0));
  add(hash, model.body_triangles);
  std::vector<std::uint32_t> indices;
  for (const BodyRange& body : model.bodies)
    indices.insert(indices.end(), {body.first_vertex, body.vertex_count, body.first_triangle,
                                   body.triangle_count, body.box ? 1u : 0u});
  for (const Spring& spring : model.springs())
    indices.insert(indices.end(), spring.vertices.begin(), spring.vertices.end());
  add(hash, indices);
  std::vector<double> numbers{static_cast<double>(steps)};
  if (scene.collides(scene::ContactKind::surface)) numbers.push_back(scene.self_collision->thickness);
  for (const scene::Collider& collider : scene.colliders) {
    if (collider.is_body()) continue;
    const auto [kind, solid] = solid_at_start(collider, 0.0);
    for (const dvec3& x :
         {solid.point, solid.direction, solid.second, solid.extent, dvec3(kind, solid.radius, 0.0)})
      numbers.insert(numbers.end(), {x.x, x.y, x.z});
  }
  add(hash, numbers);
  return hash.text();
}

std::optional<DressMemory::Found> DressMemory::find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto at =
      std::find_if(found_.begin(), found_.end(), [&](const Found& each) { return each.key == key; });
  return at == found_.end() ? std::nullopt : std::optional(*at);
}

void DressMemory::keep(Found found) {
  const std::lock_guard lock(mutex_);
  vertices_ += found.places.size();
  found_.push_back(std::move(found));
  while (found_.size() > 1 && (found_.size() > most_kept || vertices_ > most_vertices)) {
    vertices_ -= found_.front().places.size();
    found_.pop_front();
  }
}

}  // namespace clothlab::model
