#include "server/scene/vertex_numbers.h"

#include <variant>
#include <vector>

#include "server/scene/sections.h"

namespace clothlab::scene {

namespace {

/// TriangleMesh::vertex_of; null: every vertex has its own number.
const std::vector<std::uint32_t>* numbers_of(const Mesh& mesh) {
  const TriangleMesh* triangles = std::get_if<TriangleMesh>(&mesh);
  return triangles && !triangles->vertex_of.empty() ? &triangles->vertex_of : nullptr;
}

}  // namespace

std::size_t counted_vertices(const Mesh& mesh) {
  const std::vector<std::uint32_t>* numbers = numbers_of(mesh);
  return numbers ? numbers->size() : vertex_count(mesh);
}

std::uint32_t vertex_of(const Mesh& mesh, std::uint32_t number) {
  const std::vector<std::uint32_t>* numbers = numbers_of(mesh);
  return numbers ? (*numbers)[number] : number;
}

std::vector<std::uint32_t> numbers_in_frames(const Mesh& mesh, std::uint32_t first_vertex, std::size_t first,
                                             std::size_t end) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(end - first);
  for (std::size_t i = first; i < end; ++i) {
    const std::uint32_t vertex = vertex_of(mesh, static_cast<std::uint32_t>(i));
    numbers.push_back(vertex == mesh::no_vertex ? vertex : first_vertex + vertex);
  }
  return numbers;
}

bool renumbered(const Mesh& mesh) {
  const std::vector<std::uint32_t>* numbers = numbers_of(mesh);
  for (std::uint32_t number = 0; numbers && number < numbers->size(); ++number)
    if ((*numbers)[number] != number) return true;
  return false;
}

}  // namespace clothlab::scene
