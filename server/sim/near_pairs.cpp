#include "server/sim/near_pairs.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "server/model/bodies.h"
#include "server/scene/solid.h"
#include "server/sim/colliders.h"
#include "server/sim/kernels.h"
#include "shaders/elements/elements.h"

namespace clothlab::sim {

namespace {

using glm::dvec3;
using Kind = NearPair::Kind;

/// The numbers in the scene of the vertices in memory, those of bodies included: they stay where they are.
std::vector<std::uint32_t> numbers_in_scene(const Kernels& kernels) {
  const std::uint32_t cloths = kernels.model.vertex_count();
  std::vector<std::uint32_t> numbers(cloths + kernels.model.body_vertex_count());
  for (std::uint32_t i = 0; i < numbers.size(); ++i)
    numbers[i < cloths && !kernels.places.empty() ? kernels.places[i] : i] = i;
  return numbers;
}

struct Near {
  const std::vector<dvec3>& place;  ///< of cloths' vertices in the scene's order, then of bodies' [m]
  std::uint32_t cloth_vertices;
  std::vector<NearPair>& pairs;

  void add(NearPair pair) const {
    if (pair.gap < near_share * pair.keep) pairs.push_back(pair);
  }

  void add_vertices(std::uint32_t a, std::uint32_t b, double keep) const {
    NearPair pair{Kind::vertex_vertex, {a, b, NearPair::none, NearPair::none}, {1, 1}, {place[a], place[b]}};
    pair.gap = glm::distance(place[a], place[b]);
    pair.keep = keep;
    add(pair);
  }

  /// As shaders/surface/surface.glsl keeps them apart: within the triangle, or within both edges, by the
  /// thickness; at the corners of bodies by half of it. At other rims another pair is nearer.
  void add_surfaces(bool edges, const std::array<std::uint32_t, 4>& vertices, double thickness) const {
    elements::Corners corners;
    for (std::size_t k = 0; k < 4; ++k) corners.x[k] = place[vertices[k]] - place[vertices[0]];
    const elements::Separation apart = elements::separation(edges, corners);
    const bool within =
        std::all_of(apart.weight, apart.weight + 4, [](double weight) { return weight != 0.0; });
    const bool at_body = std::max(vertices[0], vertices[3]) >= cloth_vertices;
    if (!within && !at_body) return;
    NearPair pair{edges ? Kind::edge_edge : Kind::vertex_triangle, vertices, {}, {dvec3(0.0), dvec3(0.0)}};
    for (std::size_t k = 0; k < 4; ++k) {
      const bool of_first = k == 0 || (edges && k == 1);
      const double share = of_first ? apart.weight[k] : -apart.weight[k];
      pair.shares[k] = static_cast<float>(share);
      pair.nearest[of_first ? 0 : 1] += share * place[vertices[k]];
    }
    pair.gap = apart.gap;
    pair.keep = within ? thickness : 0.5 * thickness;
    add(pair);
  }
};

/// The distance of x from a solid's surface [m], less than 0 inside, and the unit normal where it is nearest.
double distance_from(const scene::Solid& solid, const dvec3& x, dvec3& normal) {
  const elements::Solid shape{solid.point, solid.direction, solid.radius, solid.second, solid.extent};
  if (solid.kind == elements::solid_plane) {
    normal = solid.direction;
    return -elements::plane_depth(shape, x);
  }
  if (!elements::solid_has_axes(solid.kind)) {
    const double apart = glm::distance(x, solid.point);
    normal = apart > 0.0 ? (x - solid.point) / apart : dvec3(0.0, 1.0, 0.0);
    return apart - solid.radius;
  }
  dvec3 along;
  const double depth =
      elements::body_depth(solid.extent, solid.radius, elements::along_axes(shape, x - solid.point), along);
  normal = solid.direction * along.x + solid.second * along.y +
           glm::cross(solid.direction, solid.second) * along.z;
  return -depth;
}

void add_solids(const Near& near, const model::Model& model, const scene::Scene& scene, double time) {
  const std::vector<scene::Collider> colliders = colliders_at(scene, time);
  for (std::uint32_t collider = 0; collider < colliders.size(); ++collider) {
    if (colliders[collider].shape.index() >= scene::solid_kinds) continue;
    const scene::Solid solid = scene::solid(colliders[collider].shape);
    for (std::uint32_t i = 0; i < near.cloth_vertices; ++i) {
      if (model.pin_motion[i] != model::not_pinned) continue;
      dvec3 normal;
      NearPair pair{Kind::vertex_solid, {i, collider, NearPair::none, NearPair::none}, {1}, {near.place[i]}};
      pair.gap = distance_from(solid, near.place[i], normal);
      pair.nearest[1] = near.place[i] - normal * pair.gap;
      pair.keep = contact_margin(scene, model, model.vertex_cloth[i], colliders[collider]);
      near.add(pair);
    }
  }
}

}  // namespace

NearPairs near_pairs(const Kernels& kernels, const scene::Scene& scene, const State& state, double time) {
  NearPairs found;
  const model::Model& model = kernels.scene_model();
  std::vector<dvec3> place(state.position.begin(), state.position.end());
  const std::vector<dvec3> bodies = model::body_positions(model, time);
  place.insert(place.end(), bodies.begin(), bodies.end());
  const Near near{place, model.vertex_count(), found.pairs};
  const std::vector<std::uint32_t> number = numbers_in_scene(kernels);
  if (kernels.self_collision) {
    const auto lists = kernels.self_collision->read_lists();
    found.searched = !lists.empty();
    for (std::uint32_t i = 0; i < lists.size(); ++i)
      for (const auto& [j, keep] : lists[i])
        if (i < j) near.add_vertices(std::min(number[i], number[j]), std::max(number[i], number[j]), keep);
  }
  if (kernels.surface_contact) {
    const double thickness = SurfacePairs::thickness(scene, model);
    found.searched = found.searched && kernels.surface_contact->searched();
    for (const SurfacePairs::Pair& pair : kernels.surface_contact->read_pairs()) {
      std::array<std::uint32_t, 4> vertices = pair.corners;
      for (std::uint32_t& vertex : vertices) vertex = number[vertex];
      if (pair.forces) near.add_surfaces(pair.edges, vertices, thickness);
    }
  }
  add_solids(near, model, scene, time);
  std::sort(found.pairs.begin(), found.pairs.end(), [](const NearPair& one, const NearPair& other) {
    const double first = one.gap * other.keep, second = other.gap * one.keep;
    return first != second ? first < second
                           : std::pair(one.kind, one.vertices) < std::pair(other.kind, other.vertices);
  });
  return found;
}

}  // namespace clothlab::sim
