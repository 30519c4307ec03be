#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <utility>

#include "server/base/text.h"
#include "server/model/mesh_arrays.h"
#include "server/model/plate.h"
#include "server/model/shell.h"
#include "server/model/start.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// The smallest mass of a vertex [kg]: the shaders multiply its inverse by stiffnesses up to 1e12 N/m, in
/// float32.
constexpr double least_mass = 1e-15;

/// Rotates points about a coordinate axis (0: x, 1: y, 2: z).
struct Turn {
  int axis = 0;
  double cosine = 1, sine = 0;
  Turn(int about, double degrees)
      : axis(about), cosine(std::cos(glm::radians(degrees))), sine(std::sin(glm::radians(degrees))) {}

  dvec3 operator()(const dvec3& point) const {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    dvec3 turned = point;
    turned[a] = cosine * point[a] - sine * point[b];
    turned[b] = sine * point[a] + cosine * point[b];
    return turned;
  }
};

std::vector<dvec3> placed(const scene::Transform& transform, std::vector<dvec3> points) {
  const std::array turns{Turn(0, transform.rotate[0]), Turn(1, transform.rotate[1]),
                         Turn(2, transform.rotate[2])};
  for (dvec3& point : points) {
    point *= transform.scale;
    for (const Turn& turn : turns) point = turn(point);
    point += transform.translate;
  }
  return points;
}

/// The vertices that the `at` of a pin or a weight selects, as indices within the cloth.
std::vector<Index> held_by(const scene::Cloth& cloth, const scene::At& at,
                           const std::vector<dvec3>& position) {
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  const Index columns = grid ? static_cast<Index>(grid->columns) : 0;
  const Index rows = grid ? static_cast<Index>(grid->rows) : 0;
  std::vector<Index> held;
  if (const auto* corner = std::get_if<scene::AtCorner>(&at)) {
    const auto column = static_cast<Index>(corner->column), row = static_cast<Index>(corner->row);
    if (column < columns && row < rows) held.push_back(row * columns + column);
  } else if (const auto* vertex = std::get_if<scene::AtVertex>(&at)) {
    if (vertex->vertex < position.size()) held.push_back(vertex->vertex);
  } else if (const auto* edge = std::get_if<scene::AtEdge>(&at)) {
    const auto line = static_cast<Index>(edge->index);
    const bool row = edge->line == scene::AtEdge::Line::row;
    if (line < (row ? rows : columns))
      for (Index i = 0; i < (row ? columns : rows); ++i)
        held.push_back(row ? line * columns + i : i * columns + line);
  } else if (const auto* box = std::get_if<scene::AtBox>(&at)) {
    for (Index i = 0; i < position.size(); ++i)
      if (glm::all(glm::lessThanEqual(box->minimum, position[i])) &&
          glm::all(glm::lessThanEqual(position[i], box->maximum)))
        held.push_back(i);
  }
  return held;
}

/// Like held_by, but an error if `at` selects no vertex; `where` is the JSON Pointer of `at`.
Result<std::vector<Index>> held_at(const std::string& where, const scene::Cloth& cloth, const scene::At& at,
                                   const std::vector<dvec3>& position) {
  std::vector<Index> held = held_by(cloth, at, position);
  if (!held.empty()) return held;
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  return Error{
      where, "selects no vertex",
      "a place on the mesh" + (grid ? ", which has " + std::to_string(grid->columns) + " columns and " +
                                          std::to_string(grid->rows) + " rows"
                                    : ", which has " + std::to_string(position.size()) + " vertices")};
}

Index motion_index(std::vector<scene::Motion>& motions, const scene::Motion& motion) {
  const auto index = static_cast<Index>(std::find(motions.begin(), motions.end(), motion) - motions.begin());
  if (index == motions.size()) motions.push_back(motion);
  return index;
}

/// Lists for each vertex the items that have it as a corner; `corners(item)` gives an item's vertices.
template <class Items, class Corners>
Adjacency adjacency(std::size_t vertex_count, const Items& items, Corners corners) {
  Adjacency result;
  result.offsets.assign(vertex_count + 1, 0);
  for (const auto& item : items)
    for (const Index vertex : corners(item)) ++result.offsets[vertex + 1];
  for (std::size_t i = 0; i < vertex_count; ++i) result.offsets[i + 1] += result.offsets[i];
  result.items.resize(result.offsets.back());
  std::vector<Index> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < items.size(); ++i)
    for (const Index vertex : corners(items[i])) result.items[next[vertex]++] = static_cast<Index>(i);
  return result;
}

/// Lists for each vertex the element corners at it, as in Batch::at_vertex.
template <class Law>
Adjacency corners_at(std::size_t vertex_count, const Batch<Law>& batch) {
  std::vector<Index> corners;
  corners.reserve(batch.size() * Element<Law>::corners);
  for (const Element<Law>& element : batch)
    corners.insert(corners.end(), element.vertices.begin(), element.vertices.end());
  return adjacency(vertex_count, corners, [](Index vertex) { return std::array{vertex}; });
}

Adjacency contact_exclusions(const Model& model) {
  Adjacency result;
  result.offsets.push_back(0);
  std::vector<Index> others;
  for (Index i = 0; i < model.vertex_count(); ++i) {
    others.clear();
    model.elements.each([&](const auto& batch) {
      batch.at(i, [&](const auto& element, std::size_t) {
        for (const Index vertex : element.vertices)
          if (vertex != i) others.push_back(vertex);
      });
    });
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    result.items.insert(result.items.end(), others.begin(), others.end());
    result.offsets.push_back(static_cast<Index>(result.items.size()));
  }
  return result;
}

double cross(const dvec2& a, const dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The flat pattern of a cloth, or null: its rest shape is that of its vertices.
const std::vector<FlatTriangle>* pattern_of(const scene::Cloth& cloth) {
  const auto* mesh = std::get_if<scene::TriangleMesh>(&cloth.mesh);
  return mesh && !mesh->pattern.empty() ? &mesh->pattern : nullptr;
}

std::vector<double> masses(const scene::Cloth& cloth, const MeshArrays& arrays,
                           const std::vector<dvec3>& position) {
  if (cloth.mass.kind == scene::Mass::Kind::per_vertex)
    return std::vector<double>(position.size(), cloth.mass.value);
  std::vector<double> mass(position.size(), 0.0);
  const std::vector<FlatTriangle>* pattern = pattern_of(cloth);
  const double scale = cloth.transform.scale;
  for (std::size_t i = 0; i < arrays.triangles.size(); ++i) {
    const auto& [a, b, c] = arrays.triangles[i];
    double area = 0.5 * glm::length(glm::cross(position[b] - position[a], position[c] - position[a]));
    if (pattern) {
      const auto& [first, second, third] = (*pattern)[i];
      area = 0.5 * scale * scale * std::abs(cross(second - first, third - first));
    }
    for (const Index corner : {a, b, c}) mass[corner] += cloth.mass.value * area / 3.0;
  }
  return mass;
}

double mean_edge_length(const MeshArrays& arrays, const std::vector<dvec3>& position) {
  double sum = 0.0;
  for (const auto& [a, b, c] : arrays.triangles)
    sum += glm::distance(position[a], position[b]) + glm::distance(position[b], position[c]) +
           glm::distance(position[c], position[a]);
  return arrays.triangles.empty() ? 0.0 : sum / (3.0 * static_cast<double>(arrays.triangles.size()));
}

/// Appends the springs of a cloth, whose vertices are the model's from `first` on. `scale`: of its transform.
void add_springs(Model& model, const scene::Springs& material, const std::vector<MeshSpring>& list,
                 Index first, double scale) {
  Batch<elements::Spring>& springs = model.elements.of<elements::Spring>();
  springs.reserve(springs.size() + list.size());
  const std::vector<dvec3>& rest = model.rest_position;
  for (const MeshSpring& spring : list) {
    const Index a = spring.a + first, b = spring.b + first;
    const double length = spring.rest > 0.0 ? spring.rest * scale : glm::distance(rest[a], rest[b]);
    springs.push_back({{a, b}, {length, stiffness(material, spring.kind), material.damping}});
  }
}

/// The axes of a mesh's texture, in space.
struct TextureAxes {
  dvec3 first, second;
};

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
  const double side = cross(piece[1] - piece[0], piece[2] - piece[0]) < 0.0 ? -1.0 : 1.0;
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
  for (Index t = first_triangle; t < model.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = model.triangles[t][k], b = model.triangles[t][(k + 1) % 3];
      const dvec3 along = glm::normalize(rest[b] - rest[a]),
                  across = rest[model.triangles[t][(k + 2) % 3]] - rest[a];
      const dvec3 inwards = glm::normalize(across - along * glm::dot(across, along));
      const auto [other, is_new] = at_edge.try_emplace(std::minmax(a, b), inwards);
      if (!is_new && glm::length(other->second + inwards) > most_angle) return true;
    }
  return false;
}

/// The rest shapes of a cloth's triangles, which are the model's from `first_triangle` on. An error if one
/// has no area.
Result<std::vector<FlatTriangle>> rest_shapes(const Model& model, const scene::Cloth& cloth, double grain,
                                              const TextureAxes& axes, Index first_triangle,
                                              const std::string& where) {
  std::vector<FlatTriangle> flat;
  const std::vector<FlatTriangle>* pattern = pattern_of(cloth);
  const std::vector<dvec3>& rest = model.rest_position;
  for (Index t = first_triangle; t < model.triangle_count(); ++t) {
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
void add_shell(Model& model, std::vector<CurvatureRows> rows, const std::vector<char>& held, Index first,
               double damping, bool sweeps_elements) {
  constexpr double flattened = 0.1;  // share of its area below which a triangle has no whole normal
  const std::vector<dvec3> rest(model.rest_position.begin() + first, model.rest_position.end());
  const std::vector<CurvedTriangle> triangles = curved_triangles(std::move(rows), rest);
  std::vector<CurvatureRows> curved;
  for (const CurvedTriangle& triangle : triangles) curved.push_back(triangle.rows);
  add_pairs(model, bending_pairs(curved, held), first, damping);
  Batch<elements::Shell>& shell = model.elements.of<elements::Shell>();
  for (const Rise& rise : rises(triangles, rest, held)) {
    const auto& [a, b, c] = rise.triangle;
    shell.push_back({{a + first, b + first, c + first, rise.vertex + first},
                     {rise.pull, 0.5 * rise.pull * rise.height, damping, flattened * rise.twice_area, 0.0}});
  }
  for (const CurvedTriangle& triangle : triangles)
    if (sweeps_elements) add_curvature(model, triangle, first, damping);
}

/// Appends the finite elements of a cloth, whose vertices and triangles are the model's from `first` and
/// `first_triangle` on; those that only sweeps visit if `sweeps_elements`. `curved`: at rest.
void add_sheet(Model& model, const scene::Fem& material, const std::vector<FlatTriangle>& flat, Index first,
               Index first_triangle, bool curved, bool sweeps_elements) {
  std::vector<std::array<Index, 3>> triangles;
  Batch<elements::Membrane>& membranes = model.elements.of<elements::Membrane>();
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const auto& [a, b, c] = model.triangles[first_triangle + i];
    membranes.push_back({{a, b, c}, membrane(flat[i], material)});
    triangles.push_back({a - first, b - first, c - first});
  }
  std::vector<char> held;
  for (Index i = first; i < model.vertex_count(); ++i) held.push_back(model.pin_motion[i] != not_pinned);
  const auto& [warp, weft, twist] = material.bending;
  const PlateStiffness plate{warp, weft, twist.value_or(0.5 * std::sqrt(warp * weft))};
  if (curved) {
    add_shell(model, curvature_rows(triangles, flat, held, plate), held, first, material.damping,
              sweeps_elements);
    return;
  }
  add_pairs(model, bending_pairs(triangles, flat, held, plate), first, material.damping);
  if (!sweeps_elements) return;
  for (const CurvatureRows& rows : curvature_rows(triangles, flat, held, plate))
    add_curvature(model, {rows, {}}, first, material.damping);
}

/// Appends one cloth to the model.
Status add_cloth(Model& model, const scene::Cloth& cloth, bool sweeps_elements) {
  const auto cloth_index = static_cast<Index>(model.cloths.size());
  const std::string where = "/cloths/" + std::to_string(cloth_index);
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  const MeshArrays arrays =
      grid ? grid_arrays(*grid, cloth.material)
           : triangle_mesh_arrays(std::get<scene::TriangleMesh>(cloth.mesh), cloth.material);
  const std::vector<dvec3> position = placed(cloth.transform, arrays.position);
  std::vector<double> mass = masses(cloth, arrays, position);
  const auto massless = std::find_if(mass.begin(), mass.end(), [](double m) { return !(m >= least_mass); });
  if (massless != mass.end())
    return Error{
        where + "/mass",
        "vertex " + std::to_string(massless - mass.begin()) + " would " +
            (*massless > 0.0 ? "weigh " + with_significant_digits(*massless, 3) + " kg" : "have no mass"),
        "with area_density every vertex belongs to triangles with an area, and weighs " +
            with_significant_digits(least_mass, 3) + " kg or more"};

  std::vector<std::int32_t> pin_motion(position.size(), not_pinned);
  for (std::size_t i = 0; i < cloth.pins.size(); ++i) {
    const auto held =
        held_at(where + "/pins/" + std::to_string(i) + "/at", cloth, cloth.pins[i].at, position);
    if (!held) return held.error();
    const auto motion = static_cast<std::int32_t>(motion_index(model.motions, cloth.pins[i].motion));
    for (const Index vertex : *held) pin_motion[vertex] = motion;
  }
  for (std::size_t i = 0; i < cloth.weights.size(); ++i) {
    const auto held =
        held_at(where + "/weights/" + std::to_string(i) + "/at", cloth, cloth.weights[i].at, position);
    if (!held) return held.error();
    for (const Index vertex : *held) mass[vertex] += cloth.weights[i].mass;
  }

  const Index first = model.vertex_count();
  ClothRange range{first, static_cast<Index>(position.size()), model.triangle_count(),
                   static_cast<Index>(arrays.triangles.size()), mean_edge_length(arrays, position)};
  for (const auto& [a, b, c] : arrays.triangles) model.triangles.push_back({a + first, b + first, c + first});
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(model.rest_position, position);
  append(model.start_position, start_positions(cloth.start, position, pin_motion));
  append(model.mass, mass);
  append(model.pin_motion, pin_motion);
  append(model.texture_coordinates, arrays.texture_coordinates);
  model.vertex_cloth.resize(model.rest_position.size(), cloth_index);
  model.cloths.push_back(range);
  if (const auto* springs = std::get_if<scene::Springs>(&cloth.material)) {
    add_springs(model, *springs, arrays.springs, first, cloth.transform.scale);
    return ok();
  }
  const std::vector<dvec3> axes =
      placed(cloth.transform, {dvec3(0.0), arrays.first_axis, arrays.second_axis});
  const auto& sheet = std::get<scene::Fem>(cloth.material);
  const Result<std::vector<FlatTriangle>> flat = rest_shapes(
      model, cloth, sheet.grain, {glm::normalize(axes[1] - axes[0]), glm::normalize(axes[2] - axes[0])},
      range.first_triangle, where);
  if (!flat) return flat.error();
  const bool curved = !pattern_of(cloth) && is_curved(model, range.first_triangle);
  add_sheet(model, sheet, *flat, first, range.first_triangle, curved, sweeps_elements);
  return ok();
}

}  // namespace

double stiffness(const scene::Springs& material, SpringKind kind) {
  switch (kind) {
    case SpringKind::structural:
      return material.structural;
    case SpringKind::shear:
      return material.shear;
    case SpringKind::bend:
      return material.bend;
  }
  return 0.0;
}

Result<Model> build(const scene::Scene& scene) {
  Model model;
  const bool sweeps_elements =
      scene::sweeps(scene.solver.method) && !scene::sweeps_vertices(scene.solver.method);
  for (const scene::Cloth& cloth : scene.cloths)
    if (Status added = add_cloth(model, cloth, sweeps_elements); !added) return added.error();
  model.elements.each_of_all([&](auto& batch) { batch.at_vertex = corners_at(model.vertex_count(), batch); });
  if (scene.self_collision) model.contact_exclusions = contact_exclusions(model);
  model.vertex_triangles =
      adjacency(model.vertex_count(), model.triangles, [](const auto& corners) { return corners; });
  return model;
}

}  // namespace clothlab::model
