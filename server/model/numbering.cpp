// Reverse Cuthill-McKee: Cuthill & McKee 1969, "Reducing the bandwidth of sparse symmetric matrices"; George
// 1971.
#include "server/model/numbering.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <variant>

#include "server/base/pieces.h"
#include "server/model/adjacency.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// A state of this many vertices takes 128 KiB and fits any processor's cache.
constexpr Index few_vertices = 4096;
/// Worth the cost of a copy for each frame: tests/bench/numbering.mjs.
constexpr double worth_while = 0.5;

/// The mean distance in memory between the ends of the sides of a cloth's triangles.
template <class Place>
double mean_distance(const Model& model, const ClothRange& cloth, Place&& place) {
  double sum = 0.0;
  for (Index t = cloth.first_triangle; t < cloth.first_triangle + cloth.triangle_count; ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = place(model.triangles[t][i]), b = place(model.triangles[t][(i + 1) % 3]);
      sum += std::abs(static_cast<double>(a) - static_cast<double>(b));
    }
  return sum / std::max(1.0, 3.0 * cloth.triangle_count);
}

/// Breadth first through each part of the mesh, from a vertex with few neighbours, those with fewer first.
class CuthillMcKee {
 public:
  explicit CuthillMcKee(const Model& model) : model_(model), seen_(model.vertex_count(), 0) {}

  /// The vertices of one cloth, in the order in which they are to lie in memory.
  std::vector<Index> order_of(const ClothRange& cloth) {
    std::vector<Index> order, seeds(cloth.vertex_count);
    std::iota(seeds.begin(), seeds.end(), cloth.first_vertex);
    std::stable_sort(seeds.begin(), seeds.end(), [&](Index a, Index b) { return degree(a) < degree(b); });
    for (const Index seed : seeds) {
      if (seen_[seed]) continue;
      std::size_t at = order.size();
      visit(seed, order);
      for (; at < order.size(); ++at) {
        const std::size_t first = order.size();
        each_neighbour(order[at], [&](Index next) { visit(next, order); });
        std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(),
                         [&](Index a, Index b) { return degree(a) < degree(b); });
      }
    }
    std::reverse(order.begin(), order.end());
    return order;
  }

 private:
  Index degree(Index vertex) const {
    return model_.vertex_triangles.offsets[vertex + 1] - model_.vertex_triangles.offsets[vertex];
  }
  template <class Visit>
  void each_neighbour(Index vertex, Visit&& found) const {
    for (Index at = model_.vertex_triangles.offsets[vertex]; at < model_.vertex_triangles.offsets[vertex + 1];
         ++at)
      for (const Index corner : model_.triangles[model_.vertex_triangles.items[at]]) found(corner);
  }
  void visit(Index vertex, std::vector<Index>& order) {
    if (std::exchange(seen_[vertex], 1)) return;
    order.push_back(vertex);
  }

  const Model& model_;
  std::vector<char> seen_;
};

template <class Value>
void permute(std::vector<Value>& values, const std::vector<Index>& places) {
  between_pieces();
  std::vector<Value> moved(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) moved[places[i]] = values[i];
  values = std::move(moved);
}

/// Sorts the elements of one cloth by their vertices: sweeps then go through memory in order.
template <class Law>
void sort_elements(Batch<Law>& batch, const ClothRange& cloth) {
  between_pieces();
  const auto first = [](const Element<Law>& element, Index vertex) { return element.vertices[0] < vertex; };
  const auto begin = std::lower_bound(batch.begin(), batch.end(), cloth.first_vertex, first);
  const auto end = std::lower_bound(begin, batch.end(), cloth.first_vertex + cloth.vertex_count, first);
  std::stable_sort(begin, end, [](const auto& a, const auto& b) { return a.vertices < b.vertices; });
}

}  // namespace

std::vector<std::uint32_t> near_places(const Model& model, const scene::Scene& scene) {
  if (model.vertex_count() < few_vertices) return {};
  std::vector<Index> places(model.vertex_count());
  std::iota(places.begin(), places.end(), 0u);
  CuthillMcKee numbering(model);
  bool any = false;
  for (std::size_t i = 0; i < model.cloths.size(); ++i) {
    if (std::holds_alternative<scene::Grid>(scene.cloths[i].mesh)) continue;
    const ClothRange& cloth = model.cloths[i];
    std::vector<Index> moved = places;
    Index place = cloth.first_vertex;
    for (const Index vertex : numbering.order_of(cloth)) moved[vertex] = place++;
    const double before = mean_distance(model, cloth, [](Index vertex) { return vertex; });
    const double after = mean_distance(model, cloth, [&](Index vertex) { return moved[vertex]; });
    if (after > worth_while * before) continue;
    places = std::move(moved);
    any = true;
  }
  return any ? places : std::vector<Index>{};
}

Model renumbered(const Model& model, const std::vector<std::uint32_t>& places) {
  Model result = model;
  permute(result.rest_position, places);
  permute(result.start_position, places);
  permute(result.mass, places);
  permute(result.pin_motion, places);
  permute(result.vertex_cloth, places);
  permute(result.texture_coordinates, places);
  for (auto& corners : result.triangles)
    for (Index& corner : corners) corner = places[corner];
  result.elements.each_of_all([&](auto& batch) {
    for (auto& element : batch) {
      for (Index& vertex : element.vertices) vertex = places[vertex];
      if constexpr (std::tuple_size_v<decltype(element.vertices)> == 2)
        std::sort(element.vertices.begin(), element.vertices.end());
    }
    for (const ClothRange& cloth : result.cloths) sort_elements(batch, cloth);
  });
  list_neighbours(result, !model.contact_exclusions.offsets.empty());
  return result;
}

}  // namespace clothlab::model
