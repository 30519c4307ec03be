#include "server/model/sheet.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <utility>

#include "server/base/pieces.h"
#include "server/model/shell.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// A triangle in its own plane, with x along the warp: `grain` [degrees] from the first texture axis, towards
/// the second.
FlatTriangle laid_flat(const std::array<dvec3, 3>& corners, const TextureAxes& axes, double grain) {
  const dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const auto in_plane = [&](const dvec3& axis) { return axis - normal * glm::dot(normal, axis); };
  dvec3 along = in_plane(axes.first);
  if (glm::length(along) < 1e-6) along = in_plane(axes.second);
  along = glm::normalize(along);
  const dvec3 across = glm::cross(normal, along);
  const double turn = glm::radians(glm::dot(across, axes.second) < 0.0 ? -grain : grain);
  const dvec3 warp = std::cos(turn) * along + std::sin(turn) * across, weft = glm::cross(normal, warp);
  FlatTriangle flat;
  for (std::size_t i = 0; i < 3; ++i)
    flat[i] = {glm::dot(corners[i] - corners[0], warp), glm::dot(corners[i] - corners[0], weft)};
  return flat;
}

/// A triangle of a pattern, with x along the warp: `grain` [degrees] from the pattern's first axis towards
/// its second. Pieces that were cut with the pattern turned over are turned back.
FlatTriangle cut_out(const FlatTriangle& piece, double scale, double grain) {
  const double turn = glm::radians(grain);
  const dvec2 warp = scale * dvec2(std::cos(turn), std::sin(turn)), weft(-warp.y, warp.x);
  const double side =
      glm::determinant(glm::dmat2(piece[1] - piece[0], piece[2] - piece[0])) < 0.0 ? -1.0 : 1.0;
  FlatTriangle flat;
  for (std::size_t i = 0; i < 3; ++i)
    flat[i] = {glm::dot(piece[i] - piece[0], warp), side * glm::dot(piece[i] - piece[0], weft)};
  return flat;
}

/// Twice the least area of a triangle over the square of its longest edge. Places in 32-bit floats cannot
/// tell a triangle below it from a line.
constexpr double least_area = 1e-7;

/// True if two triangles at an edge, of those from `first_triangle` on, meet at an angle [rad] that is more
/// than what rounding makes, or lie on each other.
bool is_curved(const Model& model, Index first_triangle) {
  constexpr double most_angle = 1e-3;
  std::map<std::pair<Index, Index>, dvec3> at_edge;  // from the edge into the first triangle there
  const std::vector<dvec3>& rest = model.rest_position;
  Pieces pieces;
  for (Index t = first_triangle; t < model.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      pieces.next();
      const Index a = model.triangles[t][k], b = model.triangles[t][(k + 1) % 3];
      const dvec3 along = glm::normalize(rest[b] - rest[a]),
                  across = rest[model.triangles[t][(k + 2) % 3]] - rest[a];
      const dvec3 inwards = glm::normalize(across - along * glm::dot(across, along));
      const auto [other, is_new] = at_edge.try_emplace(std::minmax(a, b), inwards);
      if (!is_new && glm::length(other->second + inwards) > most_angle) return true;
    }
  return false;
}

/// The rest shapes of the last cloth's triangles. An error if one has no area.
Result<std::vector<FlatTriangle>> rest_shapes(const Model& model, const scene::Cloth& cloth, double grain,
                                              const TextureAxes& axes) {
  const std::string where = "/cloths/" + std::to_string(model.cloths.size() - 1);
  const Index first_triangle = model.cloths.back().first_triangle;
  std::vector<FlatTriangle> flat;
  const std::vector<FlatTriangle>* pattern = pattern_of(cloth);
  const std::vector<dvec3>& rest = model.rest_position;
  Pieces pieces;
  for (Index t = first_triangle; t < model.triangle_count(); ++t) {
    pieces.next();
    if (pattern) {
      flat.push_back(cut_out((*pattern)[t - first_triangle], cloth.transform.scale, grain));
      continue;
    }
    const auto& [a, b, c] = model.triangles[t];
    const double longest = std::max(
        {glm::distance(rest[a], rest[b]), glm::distance(rest[b], rest[c]), glm::distance(rest[c], rest[a])});
    if (!(glm::length(glm::cross(rest[b] - rest[a], rest[c] - rest[a])) > least_area * longest * longest))
      return Error{where + "/mesh/triangles/" + std::to_string(t - first_triangle), "a triangle without area",
                   "with \"model\": \"fem\" every triangle has an area; springs need none"};
    flat.push_back(laid_flat({rest[a], rest[b], rest[c]}, axes, grain));
  }
  return flat;
}

elements::Membrane membrane(const FlatTriangle& flat, const scene::Fem& material) {
  const dvec2 a = flat[1] - flat[0], b = flat[2] - flat[0];
  const double twice_area = a.x * b.y - a.y * b.x, area = 0.5 * twice_area;
  const double ratio = material.weft / material.warp;
  const double scale = area / (1.0 - material.poisson * material.poisson * ratio);
  return {b.y / twice_area,
          -b.x / twice_area,
          -a.y / twice_area,
          a.x / twice_area,
          scale * material.warp,
          scale * material.weft,
          scale * material.poisson * material.weft,
          area * material.shear,
          material.damping};
}

void add_pairs(Model& model, const std::vector<BendingPair>& pairs, Index first, double damping) {
  Batch<elements::Bending>& bending = model.elements.of<elements::Bending>();
  for (const BendingPair& pair : pairs)
    bending.push_back({{pair.a + first, pair.b + first}, {pair.stiffness, damping}});
}

/// Appends what XPBD visits of a triangle that bends.
void add_curvature(Model& model, const CurvedTriangle& triangle, Index first, double damping) {
  Element<elements::Curvature> element{triangle.rows.vertices, {{}, {}, damping}};
  for (std::uint32_t& vertex : element.vertices) vertex += first;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& row = triangle.rows.row[a];
    std::copy(row.begin(), row.end(), element.law.row + a * CurvatureRows::most_vertices);
    element.law.rest[a] = triangle.along_normal[a];
  }
  model.elements.of<elements::Curvature>().push_back(element);
}

/// Appends the bending of a sheet whose rest shape is that of its vertices, which are curved.
void add_shell(Model& model, std::vector<CurvatureRows> rows, Index first, double damping,
               bool sweeps_elements) {
  constexpr double flattened = 0.1;  // share of its area below which a triangle has no whole normal
  const std::vector<dvec3> rest(model.rest_position.begin() + first, model.rest_position.end());
  const std::vector<CurvedTriangle> triangles = curved_triangles(std::move(rows), rest);
  std::vector<CurvatureRows> curved;
  for (const CurvedTriangle& triangle : triangles) curved.push_back(triangle.rows);
  add_pairs(model, bending_pairs(curved), first, damping);
  Batch<elements::Shell>& shell = model.elements.of<elements::Shell>();
  for (const Rise& rise : rises(triangles, rest)) {
    const auto& [a, b, c] = rise.triangle;
    shell.push_back({{a + first, b + first, c + first, rise.vertex + first},
                     {rise.pull, 0.5 * rise.pull * rise.height, damping, flattened * rise.twice_area, 0.0}});
  }
  for (const CurvedTriangle& triangle : triangles)
    if (sweeps_elements) add_curvature(model, triangle, first, damping);
}

}  // namespace

const std::vector<FlatTriangle>* pattern_of(const scene::Cloth& cloth) {
  const auto* mesh = std::get_if<scene::TriangleMesh>(&cloth.mesh);
  return mesh && !mesh->pattern.empty() ? &mesh->pattern : nullptr;
}

Status add_sheet(Model& model, const scene::Cloth& cloth, const TextureAxes& axes, bool sweeps_elements) {
  const auto& material = std::get<scene::Fem>(cloth.material);
  const Index first = model.cloths.back().first_vertex, first_triangle = model.cloths.back().first_triangle;
  const Result<std::vector<FlatTriangle>> shapes = rest_shapes(model, cloth, material.grain, axes);
  if (!shapes) return shapes.error();
  const std::vector<FlatTriangle>& flat = *shapes;
  std::vector<std::array<Index, 3>> triangles;
  Batch<elements::Membrane>& membranes = model.elements.of<elements::Membrane>();
  Pieces pieces;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    pieces.next();
    const auto& [a, b, c] = model.triangles[first_triangle + i];
    membranes.push_back({{a, b, c}, membrane(flat[i], material)});
    triangles.push_back({a - first, b - first, c - first});
  }
  std::vector<char> held;
  for (Index i = first; i < model.vertex_count(); ++i) held.push_back(model.pin_motion[i] != not_pinned);
  const auto& [warp, weft, twist] = material.bending;
  const PlateStiffness plate{warp, weft, twist.value_or(0.5 * std::sqrt(warp * weft))};
  if (!pattern_of(cloth) && is_curved(model, first_triangle)) {
    add_shell(model, curvature_rows(triangles, flat, held, plate), first, material.damping, sweeps_elements);
    return ok();
  }
  add_pairs(model, bending_pairs(triangles, flat, held, plate), first, material.damping);
  if (!sweeps_elements) return ok();
  for (const CurvatureRows& rows : curvature_rows(triangles, flat, held, plate))
    add_curvature(model, {rows, {}}, first, material.damping);
  return ok();
}

}  // namespace clothlab::model
