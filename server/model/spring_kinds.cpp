#include "server/model/spring_kinds.h"

#include <algorithm>
#include <array>
#include <utility>

namespace clothlab::model {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The edges of the model's triangles in rising order, the lower vertex first.
std::vector<Edge> edges_of(const Model& model) {
  std::vector<Edge> edges;
  edges.reserve(3 * model.triangles.size());
  for (const auto& [a, b, c] : model.triangles)
    for (const auto& [v, w] : std::array{Edge{a, b}, Edge{b, c}, Edge{c, a}})
      edges.push_back(std::minmax(v, w));
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Of two vertices of a grid, by how many columns and rows they are apart.
SpringKind kind_in_grid(std::uint32_t columns, std::uint32_t a, std::uint32_t b) {
  const auto apart = [](std::uint32_t v, std::uint32_t w) { return v < w ? w - v : v - w; };
  const std::uint32_t across = apart(a % columns, b % columns), down = apart(a / columns, b / columns);
  if (across == 1 && down == 1) return SpringKind::shear;
  return across + down == 1 ? SpringKind::structural : SpringKind::bend;
}

}  // namespace

std::vector<SpringKind> spring_kinds(const Model& model, const scene::Scene& scene) {
  std::vector<SpringKind> kinds;
  kinds.reserve(model.springs().size());
  std::vector<Edge> edges;
  for (const Spring& spring : model.springs()) {
    const auto& [a, b] = spring.vertices;
    const std::uint32_t cloth = model.vertex_cloth[a], first = model.cloths[cloth].first_vertex;
    if (const auto* grid = std::get_if<scene::Grid>(&scene.cloths[cloth].mesh)) {
      kinds.push_back(kind_in_grid(static_cast<std::uint32_t>(grid->columns), a - first, b - first));
      continue;
    }
    if (edges.empty()) edges = edges_of(model);
    const bool edge = std::binary_search(edges.begin(), edges.end(), Edge(std::minmax(a, b)));
    kinds.push_back(edge ? SpringKind::structural : SpringKind::bend);
  }
  return kinds;
}

}  // namespace clothlab::model
