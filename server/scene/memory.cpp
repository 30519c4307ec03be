#include "server/scene/memory.h"

#include <algorithm>
#include <numeric>

namespace clothlab::scene {

namespace {

/// glibc's malloc has 8 bytes of its own in a piece, which are multiples of 16, 32 at least.
std::size_t piece(std::size_t bytes) {
  return std::max<std::size_t>(32, (bytes + 8 + 15) / 16 * 16);
}

/// Short strings lie in the object itself.
std::size_t outside(const std::string& text) {
  return text.capacity() > 15 ? piece(text.capacity() + 1) : 0;
}

template <class T>
std::size_t outside(const std::vector<T>& list) {
  return list.capacity() > 0 ? piece(list.capacity() * sizeof(T)) : 0;
}

std::size_t outside(const TriangleMesh& mesh) {
  std::size_t sum = outside(mesh.vertices) + outside(mesh.triangles) + outside(mesh.pattern) +
                    outside(mesh.vertex_of) + outside(mesh.runs);
  for (const std::string& note : mesh.notes) sum += sizeof note + outside(note);
  for (const NamedRun& run : mesh.runs) sum += sizeof run + outside(run.name) + outside(run.vertices);
  return sum;
}

std::size_t outside(const Cloth& cloth) {
  const auto* mesh = std::get_if<TriangleMesh>(&cloth.mesh);
  return (mesh ? outside(*mesh) : 0) + outside(cloth.pins) + outside(cloth.weights) + outside(cloth.name);
}

std::size_t outside(const Collider& collider) {
  const auto* body = std::get_if<Body>(&collider.shape);
  return (body ? piece(sizeof(TriangleMesh)) + outside(*body->mesh) : 0) + outside(collider.name);
}

std::size_t outside(const Key& key) {
  return outside(key.of) + outside(key.times) + outside(key.values);
}

/// The nodes of the tree in which an object keeps its keys.
constexpr std::size_t node_links = 32;

/// Without the value itself, which lies in its parent.
std::size_t outside(const json& value) {
  switch (value.type()) {
    case json::value_t::object: {
      const auto& object = value.get_ref<const json::object_t&>();
      std::size_t sum = piece(sizeof object);
      for (const auto& [key, of] : object)
        sum += piece(node_links + sizeof key + sizeof of) + outside(key) + outside(of);
      return sum;
    }
    case json::value_t::array: {
      const auto& array = value.get_ref<const json::array_t&>();
      return std::accumulate(array.begin(), array.end(), piece(sizeof array) + outside(array),
                             [](std::size_t sum, const json& of) { return sum + outside(of); });
    }
    case json::value_t::string: {
      const auto& text = value.get_ref<const json::string_t&>();
      return piece(sizeof text) + outside(text);
    }
    default:
      return 0;
  }
}

}  // namespace

std::size_t memory_of(const json& value) {
  return sizeof value + outside(value);
}

std::size_t memory_of(const Scene& scene) {
  std::size_t sum = sizeof scene + outside(scene.name) + outside(scene.cloths) + outside(scene.colliders) +
                    outside(scene.keys);
  for (const Key& key : scene.keys) sum += outside(key);
  for (const Cloth& cloth : scene.cloths) sum += outside(cloth);
  for (const Collider& collider : scene.colliders) sum += outside(collider);
  return sum;
}

}  // namespace clothlab::scene
