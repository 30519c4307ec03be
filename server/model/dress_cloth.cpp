#include "server/model/dress_cloth.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "server/base/disjoint_sets.h"
#include "server/base/pieces.h"
#include "server/model/triangle_geometry.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

constexpr int sweeps = 8;  // of a step
/// Of the distance across an edge, which resists bending: a tenth of what an edge has, as cloth bends easily.
constexpr double across_stiffness = 0.1;

}  // namespace

DressCloth::DressCloth(const Model& model, const std::vector<std::uint8_t>& led_out)
    : x(model.start_position), triangles(model.triangles), weight_(model.vertex_count(), 0.0) {
  for (Index i = 0; i < weight_.size(); ++i)
    if (led_out[model.vertex_cloth[i]] && model.pin_motion[i] == not_pinned) weight_[i] = 1.0;
  for (Index t = 0; t < triangles.size(); ++t) index_[triangles[t]] = t;
  list_edges();
  between_pieces();
  list_lengths(model);
  list_pieces();
}

void DressCloth::list_edges() {
  std::vector<std::pair<Edge, Index>> sides;
  for (Index t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      sides.emplace_back(in_order(triangles[t][k], triangles[t][(k + 1) % 3]), t);
  std::sort(sides.begin(), sides.end());
  border_.assign(x.size(), false);
  for (const auto& [edge, triangle] : sides) {
    if (edges.empty() || edges.back() != edge) {
      edges.push_back(edge);
      first_at_edge_.push_back(static_cast<Index>(at_edge_.size()));
    }
    at_edge_.push_back(triangle);
  }
  first_at_edge_.push_back(static_cast<Index>(at_edge_.size()));
  for (Index e = 0; e < edges.size(); ++e)
    if (first_at_edge_[e + 1] - first_at_edge_[e] == 1)
      for (const Index end : edges[e]) border_[end] = true;
}

void DressCloth::list_lengths(const Model& model) {
  double sum = 0.0, count = 0.0;
  for (Index e = 0; e < edges.size(); ++e) {
    const auto [a, b] = edges[e];
    const double length = glm::distance(x[a], x[b]);
    if (!moves(a) && !moves(b)) continue;
    sum += length;
    count += 1.0;
    lengths_.push_back({a, b, length, 1.0});
    if (first_at_edge_[e + 1] - first_at_edge_[e] != 2) continue;
    std::array<Index, 2> far{};
    for (std::size_t k = 0; k < 2; ++k) far[k] = opposite(triangles[at_edge_[first_at_edge_[e] + k]], a, b);
    lengths_.push_back({far[0], far[1], glm::distance(x[far[0]], x[far[1]]), across_stiffness});
  }
  // Seams between pieces, and springs that are no edges of triangles.
  for (const Spring& spring : model.springs()) {
    const auto [a, b] = spring.vertices;
    if (!moves(a) && !moves(b)) continue;
    if (std::binary_search(edges.begin(), edges.end(), in_order(a, b))) continue;
    lengths_.push_back({a, b, glm::distance(x[a], x[b]), across_stiffness});
  }
  mean_edge_ = count > 0.0 ? sum / count : 0.0;
}

void DressCloth::list_pieces() {
  DisjointSets pieces(x.size());
  for (const auto& [a, b] : edges) pieces.join(a, b);
  for (Index i = 0; i < x.size(); ++i) piece.push_back(pieces.find(i));
}

std::span<const Index> DressCloth::triangles_at(const Edge& edge) const {
  const auto at = std::lower_bound(edges.begin(), edges.end(), edge);
  if (at == edges.end() || *at != edge) return {};
  const auto e = static_cast<std::size_t>(at - edges.begin());
  return std::span(at_edge_).subspan(first_at_edge_[e], first_at_edge_[e + 1] - first_at_edge_[e]);
}

void DressCloth::keep_lengths() {
  for (const Length& each : lengths_) {
    const double sum = weight_[each.a] + weight_[each.b];
    const dvec3 apart = x[each.b] - x[each.a];
    const double length = glm::length(apart);
    if (!(length > 0.0) || sum == 0.0) continue;
    const dvec3 move = apart * (each.stiffness * (length - each.length) / (length * sum));
    x[each.a] += weight_[each.a] * move;
    x[each.b] -= weight_[each.b] * move;
  }
}

void DressCloth::keep(const Demand& demand, double most) {
  double now = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < demand.vertices.size(); ++k) {
    const double share = demand.shares[k];
    if (share == 0.0) continue;
    now += share * glm::dot(demand.normal, x[demand.vertices[k]]);
    sum += weight_[demand.vertices[k]] * share * share;
  }
  if (now >= demand.least || sum == 0.0) return;
  const double lacks = std::min(demand.least - now, most);
  for (std::size_t k = 0; k < demand.vertices.size(); ++k)
    if (demand.shares[k] != 0.0)
      x[demand.vertices[k]] += demand.normal * (weight_[demand.vertices[k]] * demand.shares[k] * lacks / sum);
}

void DressCloth::relax(const std::vector<Demand>& demands, double most) {
  const std::vector<dvec3> before = x;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    between_pieces();
    keep_lengths();
    for (const Demand& demand : demands) keep(demand, most);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double way = glm::distance(before[i], x[i]);
    if (way > most) x[i] = before[i] + (x[i] - before[i]) * (most / way);
  }
}

double DressCloth::squared_strain() const {
  double sum = 0.0;
  for (const Length& each : lengths_) {
    if (each.stiffness != 1.0 || !(each.length > 0.0)) continue;
    const double strain = glm::distance(x[each.a], x[each.b]) / each.length - 1.0;
    sum += strain * strain;
  }
  return sum;
}

}  // namespace clothlab::model
