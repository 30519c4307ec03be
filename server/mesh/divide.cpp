// Divides edges at the corners of other faces that lie on them, which programs leave where they cut a mesh or
// take faces without area out of it.
#include <algorithm>
#include <glm/common.hpp>

#include "server/mesh/open_places.h"
#include "server/mesh/raw.h"
#include "server/mesh/sides.h"

namespace clothlab::mesh {

namespace {

using Index = std::uint32_t;
using OnEdges = std::vector<CornerOnEdge>;

/// A triangle with the corners on its edges, as a polygon.
struct Polygon {
  std::vector<Index> vertices;
  std::vector<glm::dvec2> texture;
};

Polygon with_corners(const Mesh& mesh, OnEdges::const_iterator begin, OnEdges::const_iterator end) {
  Polygon polygon;
  const auto& corners = mesh.triangles[begin->triangle];
  const auto* texture = mesh.texture.empty() ? nullptr : &mesh.texture[begin->triangle];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    polygon.vertices.push_back(corners[i]);
    if (texture) polygon.texture.push_back((*texture)[i]);
    std::vector<std::pair<double, Index>> inside;  // of this edge, by share of the way
    for (auto on = begin; on != end; ++on) {
      if (on->from == corners[i] && on->to == corners[next]) inside.emplace_back(on->share, on->vertex);
      if (on->to == corners[i] && on->from == corners[next]) inside.emplace_back(1.0 - on->share, on->vertex);
    }
    std::sort(inside.begin(), inside.end());
    for (const auto& [share, vertex] : inside) {
      polygon.vertices.push_back(vertex);
      if (texture) polygon.texture.push_back(glm::mix((*texture)[i], (*texture)[next], share));
    }
  }
  return polygon;
}

/// The polygon's triangles, or none if they would not all have an area.
std::vector<std::array<Index, 3>> cut(const Mesh& mesh, const Polygon& polygon, std::size_t& budget) {
  std::vector<Index> sorted = polygon.vertices;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end() || sorted.size() > max_corners)
    return {};
  std::vector<glm::dvec3> places;
  for (const Index vertex : polygon.vertices) places.push_back(mesh.vertices[vertex]);
  std::vector<std::array<Index, 3>> triangles;
  if (!triangulate(places, triangles, budget).empty()) return {};
  for (const auto& [a, b, c] : triangles)
    if (has_no_area(places[a], places[b], places[c])) return {};
  return triangles;
}

}  // namespace

bool divide_edges(Mesh& mesh, double reach, const Raw& raw, Mending& mended) {
  const OnEdges on = corners_on_edges(mesh.vertices, mesh.triangles, sides_of(mesh.triangles), reach);
  std::size_t budget = 50'000'000;
  bool any = false;
  for (auto begin = on.begin(), end = begin; begin != on.end(); begin = end) {
    const Index triangle = begin->triangle;
    while (end != on.end() && end->triangle == triangle) ++end;
    if (mesh.triangles.size() + static_cast<std::size_t>(end - begin) > raw.most_triangles) break;
    const Polygon polygon = with_corners(mesh, begin, end);
    const auto parts = cut(mesh, polygon, budget);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto& [a, b, c] = parts[i];
      const std::array<Index, 3> corners{polygon.vertices[a], polygon.vertices[b], polygon.vertices[c]};
      if (i == 0)
        mesh.triangles[triangle] = corners;
      else
        mesh.triangles.push_back(corners), mesh.face_line.push_back(mesh.face_line[triangle]);
      if (mesh.texture.empty()) continue;
      const std::array<glm::dvec2, 3> texture{polygon.texture[a], polygon.texture[b], polygon.texture[c]};
      if (i == 0)
        mesh.texture[triangle] = texture;
      else
        mesh.texture.push_back(texture);
    }
    for (auto corner = begin; corner != end && !parts.empty(); ++corner)
      mended.add(Fault::on_edge, mesh.place_of(triangle));
    any = any || !parts.empty();
  }
  return any;
}

}  // namespace clothlab::mesh
