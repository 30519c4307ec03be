#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <type_traits>
#include <utility>

#include "server/base/pieces.h"
#include "server/base/text.h"
#include "server/model/adjacency.h"
#include "server/model/bodies.h"
#include "server/model/clean_start.h"
#include "server/model/dress.h"
#include "server/model/mesh_arrays.h"
#include "server/model/sheet.h"
#include "server/model/start.h"
#include "server/scene/placement.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// The smallest mass of a vertex [kg]: the shaders multiply its inverse by stiffnesses up to 1e12 N/m, in
/// float32.
constexpr double least_mass = 1e-15;

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
      area = 0.5 * scale * scale * std::abs(glm::determinant(glm::dmat2(second - first, third - first)));
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
void add_springs(Model& model, const std::vector<MeshSpring>& list, Index first, double scale) {
  Batch<elements::Spring>& springs = model.elements.of<elements::Spring>();
  springs.reserve(springs.size() + list.size());
  const std::vector<dvec3>& rest = model.rest_position;
  for (const MeshSpring& spring : list) {
    const Index a = spring.a + first, b = spring.b + first;
    const double length = spring.rest > 0.0 ? spring.rest * scale : glm::distance(rest[a], rest[b]);
    springs.push_back({{a, b}, {length, spring.stiffness, spring.damping}});
  }
}

/// Appends one cloth to the model.
Status add_cloth(Model& model, const scene::Cloth& cloth, bool sweeps_elements) {
  const auto cloth_index = static_cast<Index>(model.cloths.size());
  const std::string where = "/cloths/" + std::to_string(cloth_index);
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  const MeshArrays arrays =
      grid ? grid_arrays(*grid, cloth.material)
           : triangle_mesh_arrays(std::get<scene::TriangleMesh>(cloth.mesh), cloth.material);
  between_pieces();
  const std::vector<dvec3> position = scene::placed(cloth.transform, arrays.position);
  std::vector<double> mass = masses(cloth, arrays, position);
  const auto massless = std::find_if(mass.begin(), mass.end(), [](double m) { return !(m >= least_mass); });
  if (massless != mass.end())
    return Error{
        where + "/mass",
        "vertex " + std::to_string(massless - mass.begin()) + " would " +
            (*massless > 0.0 ? "weigh " + with_significant_digits(*massless, 3) + " kg" : "have no mass"),
        "with area_density every vertex belongs to triangles with an area, and weighs " +
            with_significant_digits(least_mass, 3) + " kg or more"};

  between_pieces();
  std::vector<std::int32_t> pin_motion(position.size(), not_pinned);
  for (std::size_t i = 0; i < cloth.pins.size(); ++i) {
    if (!cloth.pins[i].held) continue;
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

  between_pieces();
  const Index first = model.vertex_count();
  ClothRange range{first, static_cast<Index>(position.size()), model.triangle_count(),
                   static_cast<Index>(arrays.triangles.size()), mean_edge_length(arrays, position)};
  for (const auto& [a, b, c] : arrays.triangles) model.triangles.push_back({a + first, b + first, c + first});
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(model.rest_position, position);
  between_pieces();
  append(model.start_position, start_positions(cloth.start, position, pin_motion));
  append(model.mass, mass);
  append(model.pin_motion, pin_motion);
  append(model.texture_coordinates, arrays.texture_coordinates);
  model.vertex_cloth.resize(model.rest_position.size(), cloth_index);
  model.cloths.push_back(range);
  between_pieces();
  if (std::holds_alternative<scene::Springs>(cloth.material)) {
    add_springs(model, arrays.springs, first, cloth.transform.scale);
    return ok();
  }
  const std::vector<dvec3> axes =
      scene::placed(cloth.transform, {dvec3(0.0), arrays.first_axis, arrays.second_axis});
  return add_sheet(model, cloth, {glm::normalize(axes[1] - axes[0]), glm::normalize(axes[2] - axes[0])},
                   sweeps_elements);
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

namespace {

Status add_cloths(Model& model, const scene::Scene& scene) {
  const bool sweeps_elements =
      scene::sweeps(scene.solver.method) && !scene::sweeps_vertices(scene.solver.method);
  for (const scene::Cloth& cloth : scene.cloths)
    if (Status added = add_cloth(model, cloth, sweeps_elements); !added) return added;
  return ok();
}

}  // namespace

Status take_materials(Model& model, const scene::Scene& scene) {
  Model fresh;
  if (Status added = add_cloths(fresh, scene); !added) return added;
  bool same = true;
  elements::each_law<elements::AllLaws>([&]<class Law>(std::type_identity<Law>) {
    std::vector<Element<Law>>&present = model.elements.of<Law>(), &next = fresh.elements.of<Law>();
    same = same && std::equal(present.begin(), present.end(), next.begin(), next.end(),
                              [](const auto& a, const auto& b) { return a.vertices == b.vertices; });
    if (same) present = std::move(next);
  });
  return same ? ok() : Error{"/keys", "numbers that change which vertices bend together", "other numbers"};
}

Result<Model> build(const scene::Scene& scene) {
  Model model;
  if (Status added = add_cloths(model, scene); !added) return added.error();
  between_pieces();
  add_bodies(model, scene);
  between_pieces();
  dress(model, scene);
  if (Status clean = check_start(model, scene); !clean) return clean.error();
  between_pieces();
  list_neighbours(model, scene.collides(scene::ContactKind::points));
  return model;
}

}  // namespace clothlab::model
