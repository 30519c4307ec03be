#include "server/model/hold.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <queue>

#include "server/model/wind.h"

namespace clothlab::model {

namespace {

/// A cloth that hangs from one hand sags below it by this share of its size.
constexpr double sag = 0.02;
/// The most that a hand pulls, in weights of the cloth.
constexpr double most_weights = 5.0;
/// Without gravity a cloth weighs as much as on Earth: a hand has to get its mass moving, too.
constexpr double least_gravity = 9.8;  // [m/s^2]
/// A hold reaches as far as this share of the cloth's size, but at least and at most so many edges.
constexpr double wide = 0.04, least_edges = 2.0, most_edges = 8.0;

double diagonal_of(const Model& model, const ClothRange& cloth) {
  dvec3 low(1e300), high(-1e300);
  for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
    low = glm::min(low, model.rest_position[i]);
    high = glm::max(high, model.rest_position[i]);
  }
  return glm::distance(low, high);
}

double weight_of(const Model& model, const scene::Scene& scene, const ClothRange& cloth) {
  double mass = 0.0;
  for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i)
    mass += model.mass[i];
  const double wind = scene.wind ? largest_wind_speed(*scene.wind) : 0.0;
  return mass * std::max(glm::length(scene.gravity), least_gravity) +
         (wind > 0.0 ? largest_wind_power(model, scene) / wind : 0.0);
}

/// Vertices within `reach` [m] along edges of the rest shape, with that distance: straight through space the
/// two sides of a sleeve would be near each other.
std::map<std::uint32_t, double> near_vertices(const Model& model, std::uint32_t from, double reach) {
  std::map<std::uint32_t, double> distance;
  using Way = std::pair<double, std::uint32_t>;
  std::priority_queue<Way, std::vector<Way>, std::greater<>> ways;
  ways.emplace(0.0, from);
  while (!ways.empty()) {
    const auto [far, at] = ways.top();
    ways.pop();
    if (!distance.emplace(at, far).second) continue;
    const auto& offsets = model.vertex_triangles.offsets;
    for (std::uint32_t k = offsets[at]; k < offsets[at + 1]; ++k)
      for (const std::uint32_t next : model.triangles[model.vertex_triangles.items[k]]) {
        const double there = far + glm::distance(model.rest_position[at], model.rest_position[next]);
        if (there < reach && !distance.contains(next)) ways.emplace(there, next);
      }
  }
  return distance;
}

}  // namespace

Hold hold_on(const Model& model, const scene::Scene& scene, std::uint32_t vertex,
             const std::vector<glm::vec3>& position) {
  const ClothRange& cloth = model.cloths[model.vertex_cloth[vertex]];
  const double size = diagonal_of(model, cloth), weight = weight_of(model, scene, cloth);
  const double edge = cloth.mean_edge_length;
  const double reach = std::clamp(wide * size, least_edges * edge, most_edges * edge);
  Hold hold;
  hold.reach = most_weights * sag * size;
  hold.force = most_weights * weight;
  double sum = 0.0;
  const auto add = [&](std::uint32_t i, double distance) {
    if (model.pin_motion[i] != not_pinned) return;
    const double share = 1.0 - distance * distance / (reach * reach);
    hold.vertices.push_back({i, share, 0.0, dvec3(position[i]) - dvec3(position[vertex])});
    sum += share;
  };
  add(vertex, 0.0);
  for (const auto& [i, distance] : near_vertices(model, vertex, reach))
    if (i != vertex) add(i, distance);
  for (Hold::Vertex& held : hold.vertices) {
    held.stiffness *= weight / (sag * size) / sum;
    held.damping = 2.0 * std::sqrt(held.stiffness * model.mass[held.vertex]);
  }
  return hold;
}

}  // namespace clothlab::model
