#include "server/mesh/gltf_nodes.h"

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace clothlab::mesh {

namespace {

using glm::dmat4;
using nlohmann::json;

/// The numbers of a list in an object; nothing if it is absent or has others.
template <std::size_t count>
std::optional<std::array<double, count>> list_of(const json& of, const char* key) {
  const auto found = of.find(key);
  if (found == of.end() || !found->is_array() || found->size() != count) return std::nullopt;
  std::array<double, count> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    numbers[i] = (*found)[i].get<double>();
  }
  return numbers;
}

/// Of a node, against its parent.
dmat4 local_transform(const json& node) {
  if (const auto matrix = list_of<16>(node, "matrix")) {
    dmat4 local(0.0);
    for (int i = 0; i < 16; ++i) local[i / 4][i % 4] = (*matrix)[static_cast<std::size_t>(i)];
    return local;
  }
  const auto move = list_of<3>(node, "translation"), size = list_of<3>(node, "scale");
  const auto turn = list_of<4>(node, "rotation");
  dmat4 matrix(1.0);
  if (turn) {
    const glm::dquat quaternion((*turn)[3], (*turn)[0], (*turn)[1], (*turn)[2]);
    if (glm::length(quaternion) > 0.0) matrix = glm::mat4_cast(glm::normalize(quaternion));
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (size) matrix[axis] *= (*size)[static_cast<std::size_t>(axis)];
    if (move) matrix[3][axis] = (*move)[static_cast<std::size_t>(axis)];
  }
  return matrix;
}

}  // namespace

std::vector<std::size_t> indices_in(const json& of, const char* key) {
  std::vector<std::size_t> indices;
  if (const auto list = of.find(key); list != of.end() && list->is_array())
    for (const json& each : *list)
      if (each.is_number_unsigned()) indices.push_back(each.get<std::size_t>());
  return indices;
}

GltfNodes place_nodes(const GltfData& data) {
  const std::size_t count = data.count("nodes");
  GltfNodes nodes{std::vector<dmat4>(count, dmat4(1.0)), {}};
  std::vector<char> has_parent(count, 0), placed(count, 0);
  const auto node = [&](std::size_t i) -> const json& { return data.document()["nodes"][i]; };
  for (std::size_t i = 0; i < count; ++i)
    for (const std::size_t child : indices_in(node(i), "children"))
      if (child < count) has_parent[child] = 1;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < count; ++i) {
    if (has_parent[i]) continue;
    nodes.roots.push_back(i);
    open.push_back(i);
    nodes.global[i] = local_transform(node(i));
    placed[i] = 1;
  }
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    for (const std::size_t child : indices_in(node(at), "children")) {
      if (child >= count || placed[child]) continue;
      placed[child] = 1;
      nodes.global[child] = nodes.global[at] * local_transform(node(child));
      open.push_back(child);
    }
  }
  return nodes;
}

}  // namespace clothlab::mesh
