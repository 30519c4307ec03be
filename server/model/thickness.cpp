#include "server/model/thickness.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "server/base/text.h"

namespace clothlab::model {

namespace {
/// Thickness over covering radius. The thickness must exceed the radius, because a vertex that falls onto the
/// middle of a grid cell pushes the cell's corners aside, and cloth is a little longer than at rest. Of two
/// sheets, vertices over middles, one fell through the other at 1.06 times the radius, but not at 1.13.
constexpr double thickness_over_covering_radius = 1.2;

}  // namespace

double covering_radius(const dvec3& a, const dvec3& b, const dvec3& c) {
  double sides[3] = {glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
  std::sort(sides, sides + 3);
  const auto [least, middle, longest] = sides;
  const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
  if (least * least + middle * middle > longest * longest) return least * middle * longest / (4.0 * area);
  // An obtuse angle: the farthest point is on the longest side, as far from the opposite corner as from one
  // end of that side.
  const double foot = (longest * longest + middle * middle - least * least) / (2.0 * longest);
  return foot > 0.0 ? 0.5 * middle * middle / foot : 0.5 * longest;
}

double least_mean_edge(const Model& model) {
  double edge = model.cloths.empty() ? 0.0 : model.cloths.front().mean_edge_length;
  for (const ClothRange& cloth : model.cloths) edge = std::min(edge, cloth.mean_edge_length);
  return edge;
}

double least_safe_thickness(const Model& model) {
  double largest = 0.0;
  for (const auto& [a, b, c] : model.triangles)
    largest = std::max(
        largest, covering_radius(model.rest_position[a], model.rest_position[b], model.rest_position[c]));
  return thickness_over_covering_radius * largest;
}

std::string thickness_warning(const Model& model, const scene::Scene& scene) {
  if (!scene.collides(scene::ContactKind::points)) return {};
  const double holds = least_safe_thickness(model), thickness = scene.self_collision->thickness;
  if (!(thickness < holds)) return {};
  return formatted(
      "self_collision.thickness = %.3g m is too thin for this mesh: vertices can slip between the corners of "
      "a triangle; use at least %.3g m, or a mesh %.2g times as fine",
      thickness, holds, holds / thickness);
}

}  // namespace clothlab::model
