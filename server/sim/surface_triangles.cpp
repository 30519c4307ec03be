#include "server/sim/surface_triangles.h"

#include "server/base/pieces.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "shaders/elements/elements.h"

namespace clothlab::sim {

namespace {

constexpr std::uint32_t edges_bit = 0x80000000u, no_force_bit = 0x80000000u;         // as in surface.glsl
constexpr std::uint32_t owns_vertex_bit = 0x80000000u, owns_edge_bit = 0x40000000u;  // as in triangles.glsl

using Corners = std::array<std::uint32_t, 3>;

/// Halves `triangles` along their longest extent, at multiples of `block`, until each part has at most that
/// many, from then on at multiples of `leaf_size`, and of a leaf at those of `bundle_size`.
void order_by_place(std::span<std::uint32_t> triangles, const std::vector<model::dvec3>& middle,
                    std::uint32_t block) {
  if (triangles.size() <= bundle_size) return;
  if (triangles.size() > 4096) between_pieces();
  const std::size_t unit = triangles.size() > block       ? block
                           : triangles.size() > leaf_size ? leaf_size
                                                          : bundle_size;
  model::dvec3 low = middle[triangles[0]], high = low;
  for (const std::uint32_t triangle : triangles) {
    low = glm::min(low, middle[triangle]);
    high = glm::max(high, middle[triangle]);
  }
  const model::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = (triangles.size() + unit - 1) / unit / 2 * unit;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(middle[a][axis], a) < std::pair(middle[b][axis], b);
                   });
  order_by_place(triangles.first(half), middle, block);
  order_by_place(triangles.subspan(half), middle, block);
}

using Places = std::vector<model::dvec3>;

/// The triangles in an order by place. `place`: of each vertex.
std::vector<Corners> by_place(std::span<const Corners> triangles, const Places& place, std::uint32_t block) {
  Places middle;
  for (const auto& [a, b, c] : triangles) middle.push_back((place[a] + place[b] + place[c]) / 3.0);
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  order_by_place(order, middle, block);
  std::vector<Corners> ordered;
  for (const std::uint32_t triangle : order) ordered.push_back(triangles[triangle]);
  return ordered;
}

/// Triangles of a block, if at most `most_blocks` shall be enough: a multiple of leaf_size.
std::uint32_t block_size(std::size_t triangles, std::uint32_t most_blocks) {
  const auto leaves = static_cast<std::uint32_t>((triangles + leaf_size - 1) / leaf_size);
  return leaf_size * std::max((leaves + most_blocks - 1) / most_blocks, 1u);
}

/// Calls take(first, end) for the triangles of each block.
template <class Take>
void each_block(std::size_t triangles, std::uint32_t size, const Take& take) {
  for (std::size_t first = 0; first < triangles; first += size)
    take(first, std::min(first + size, triangles));
}

/// Each vertex once.
std::vector<std::uint32_t> vertices_of(std::span<const Corners> triangles) {
  std::vector<std::uint32_t> vertices;
  for (const Corners& corners : triangles) vertices.insert(vertices.end(), corners.begin(), corners.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

void add_cloths(SurfaceTriangles& made, std::vector<Corners>& triangles, const model::Model& model,
                std::uint32_t most_blocks) {
  const std::uint32_t block = block_size(model.triangles.size(), most_blocks);
  triangles = by_place(model.triangles, model.start_position, block);
  made.cloth_triangle_count = model.triangle_count();
  each_block(triangles.size(), block, [&](std::size_t first, std::size_t end) {
    made.blocks.push_back(vertices_of(std::span(triangles).subspan(first, end - first)));
  });
  made.cloth_block_count = static_cast<std::uint32_t>(made.blocks.size());
}

void add_mesh(SurfaceTriangles& made, std::vector<Corners>& triangles, const model::Model& model,
              const Places& place, std::uint32_t body, std::uint32_t most_blocks) {
  const model::BodyRange& range = model.bodies[body];
  const std::uint32_t block = block_size(range.triangle_count, most_blocks);
  const std::vector<Corners> ordered = by_place(
      std::span(model.body_triangles).subspan(range.first_triangle, range.triangle_count), place, block);
  triangles.insert(triangles.end(), ordered.begin(), ordered.end());
  each_block(ordered.size(), block, [&](std::size_t first, std::size_t end) {
    model::dvec3 low = place[ordered[first][0]], high = low;
    for (const std::uint32_t vertex : vertices_of(std::span(ordered).subspan(first, end - first))) {
      low = glm::min(low, place[vertex]);
      high = glm::max(high, place[vertex]);
    }
    std::vector<std::uint32_t>& corners = made.blocks.emplace_back();
    for (int corner = 0; corner < 8; ++corner) {
      corners.push_back(model.vertex_count() + static_cast<std::uint32_t>(made.body_places.size()));
      made.body_places.push_back(
          {{corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z}, body});
    }
  });
}

/// A box does not turn, and its corners are bounds enough.
void add_box(SurfaceTriangles& made, std::vector<Corners>& triangles, const model::Model& model,
             std::uint32_t body) {
  const std::uint32_t first = model.vertex_count() + model.bodies[body].first_vertex;
  std::vector<std::uint32_t>& block = made.blocks.emplace_back();
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    block.push_back(first + corner);
    for (const std::uint32_t axis : {1u, 2u, 4u})
      if ((corner & axis) == 0)
        triangles.push_back({first + corner, first + corner + axis, first + corner + axis});
  }
}

/// The edges that have been seen: of each vertex its few neighbours of a higher number.
class EdgesSeen {
 public:
  explicit EdgesSeen(std::uint32_t vertex_count) : higher_(vertex_count) {}

  bool is_new(std::uint32_t low, std::uint32_t high) {
    std::vector<std::uint32_t>& seen = higher_[low];
    if (std::find(seen.begin(), seen.end(), high) != seen.end()) return false;
    seen.push_back(high);
    return true;
  }

 private:
  std::vector<std::vector<std::uint32_t>> higher_;
};

std::vector<std::array<std::uint32_t, 4>> with_owned_parts(const std::vector<Corners>& triangles,
                                                           std::uint32_t vertex_count) {
  std::vector<std::array<std::uint32_t, 4>> list;
  std::vector<bool> vertex_owned(vertex_count, false);
  EdgesSeen edges(vertex_count);
  Pieces pieces;
  for (const Corners& corners : triangles) {
    pieces.next();
    std::array<std::uint32_t, 4>& tags = list.emplace_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      tags[k] = a | (vertex_owned[a] ? 0 : owns_vertex_bit);
      vertex_owned[a] = true;
      if (a != b && edges.is_new(std::min(a, b), std::max(a, b))) tags[k] |= owns_edge_bit;
    }
  }
  return list;
}

std::vector<glm::vec4> places_at_rest(const std::vector<Corners>& triangles, const model::Model& model) {
  std::vector<glm::vec4> list;
  Pieces pieces;
  for (const auto& [a, b, c] : triangles) {
    pieces.next();
    if (a >= model.vertex_count()) {
      list.insert(list.end(), {glm::vec4(0, 0, 0, -1), glm::vec4(0)});
      continue;
    }
    const glm::vec3 x(model.rest_position[a]), y(model.rest_position[b]), z(model.rest_position[c]);
    const glm::vec3 middle = 0.5f * (glm::min(x, glm::min(y, z)) + glm::max(x, glm::max(y, z)));
    const float radius =
        std::max({glm::distance(x, middle), glm::distance(y, middle), glm::distance(z, middle)});
    const glm::vec3 normal = glm::cross(y - x, z - x);
    const float size = glm::length(normal);
    list.emplace_back(middle, static_cast<float>(model.vertex_cloth[a]));
    list.emplace_back(size > 0.0f ? normal / size : normal, radius);
  }
  return list;
}

/// Lists the neighbours' pairs of `made`, whose other members must be set.
class NeighbourPairs {
 public:
  explicit NeighbourPairs(SurfaceTriangles& made) : made_(made) {}

  void add_all(std::uint32_t vertex_count) {
    std::vector<std::vector<std::uint32_t>> around(vertex_count);
    Pieces pieces;
    for (std::uint32_t i = 0; i < made_.cloth_triangle_count; ++i) {
      pieces.next();
      for (int k = 0; k < 3; ++k) around[number(i, k)].push_back(i);
    }
    std::vector<std::uint32_t> neighbours;
    for (std::uint32_t i = 0; i < made_.cloth_triangle_count; ++i) {
      pieces.next();
      neighbours.clear();
      for (int k = 0; k < 3; ++k)
        for (const std::uint32_t j : around[number(i, k)])
          if (i < j) neighbours.push_back(j);
      std::sort(neighbours.begin(), neighbours.end());
      neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
      for (const std::uint32_t j : neighbours) add(i, j);
    }
  }

  /// Puts pairs together that pass, or fail, the search's cheap tests alike (shaders/surface/reach.glsl), so
  /// that threads that run together have the same to do.
  void sort(const model::Model& model) {
    using Pair = std::array<std::uint32_t, 4>;
    const auto kind_and_gap = [&](const Pair& pair) {
      const bool edges = (pair[0] & edges_bit) != 0;
      elements::Corners c;
      for (int k = 0; k < 4; ++k) c.x[k] = model.rest_position[pair[k] & ~edges_bit];
      const model::dvec3 between =
          edges ? 0.5 * (c.x[0] + c.x[1] - c.x[2] - c.x[3]) : c.x[0] - (c.x[1] + c.x[2] + c.x[3]) / 3.0;
      const double length = glm::length(between);
      return std::pair(edges, length > 0.0 ? elements::gap_along(edges, c, between) / length : 0.0);
    };
    std::vector<Sorted> sorted;
    sorted.reserve(made_.neighbour_pairs.size());
    Pieces pieces;
    for (const Pair& pair : made_.neighbour_pairs) {
      pieces.next();
      const auto [edges, gap] = kind_and_gap(pair);
      sorted.push_back({pair, edges, gap});
    }
    std::stable_sort(sorted.begin(), sorted.end(), [&](const Sorted& a, const Sorted& b) {
      pieces.next();
      return std::pair(a.edges, a.gap) < std::pair(b.edges, b.gap);
    });
    for (std::size_t i = 0; i < sorted.size(); ++i) made_.neighbour_pairs[i] = sorted[i].pair;
  }

 private:
  struct Sorted {
    std::array<std::uint32_t, 4> pair;
    bool edges;
    double gap;
  };

  void add(std::uint32_t i, std::uint32_t j) {
    const auto &one = made_.triangles[i], &other = made_.triangles[j];
    const bool flat = side_by_side(i, j);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (one[k] & owns_vertex_bit)
        keep({number(i, k), number(j, 0), number(j, 1), number(j, 2)}, false, flat);
      if (other[k] & owns_vertex_bit)
        keep({number(j, k), number(i, 0), number(i, 1), number(i, 2)}, false, flat);
      for (int m = 0; m < 3; ++m)
        if ((one[k] & owns_edge_bit) && (other[m] & owns_edge_bit))
          keep({number(i, k), number(i, next), number(j, m), number(j, (m + 1) % 3)}, true, flat);
    }
  }

  std::uint32_t number(std::uint32_t triangle, int corner) const {
    return SurfaceTriangles::number_of(made_.triangles[triangle][corner]);
  }

  void keep(std::array<std::uint32_t, 4> pair, bool edges, bool flat) {
    for (int k = edges ? 2 : 1; k < 4; ++k)
      if (pair[k] == pair[0] || (edges && pair[k] == pair[1])) return;
    if (edges) pair[0] |= edges_bit;
    if (flat) pair[1] |= no_force_bit;
    made_.neighbour_pairs.push_back(pair);
  }

  /// As shaders/surface/triangle_pairs.comp decides it, for triangles whose boxes touch.
  bool side_by_side(std::uint32_t i, std::uint32_t j) const {
    const glm::vec3 between(made_.rest_places[2 * j] - made_.rest_places[2 * i]);
    const float flat_enough = static_cast<float>(out_of_plane) * glm::length(between);
    return std::abs(glm::dot(glm::vec3(made_.rest_places[2 * i + 1]), between)) <= flat_enough &&
           std::abs(glm::dot(glm::vec3(made_.rest_places[2 * j + 1]), between)) <= flat_enough;
  }

  SurfaceTriangles& made_;
};

}  // namespace

SurfaceTriangles surface_triangles(const model::Model& model, std::uint32_t most_blocks) {
  SurfaceTriangles made;
  const auto bodies = static_cast<std::uint32_t>(model.bodies.size());
  const auto boxes = static_cast<std::uint32_t>(
      std::count_if(model.bodies.begin(), model.bodies.end(), [](const auto& body) { return body.box; }));
  const std::uint32_t meshes = bodies - boxes;
  const std::uint32_t blocks_of_mesh = meshes > 0 ? std::max(most_blocks / 4 / meshes, 1u) : 0;
  std::vector<Corners> triangles;
  add_cloths(made, triangles, model, most_blocks - meshes * blocks_of_mesh - boxes);
  Places place = model.start_position;
  for (std::uint32_t i = 0; i < model.body_vertex_count(); ++i) {
    place.push_back(model.body_position[i]);
    made.body_places.push_back({model.body_position[i], model.vertex_body[i]});
  }
  for (std::uint32_t body = 0; body < bodies; ++body) {
    if (model.bodies[body].box)
      add_box(made, triangles, model, body);
    else
      add_mesh(made, triangles, model, place, body, blocks_of_mesh);
  }
  made.triangles = with_owned_parts(triangles, model.vertex_count() + model.body_vertex_count());
  made.rest_places = places_at_rest(triangles, model);
  NeighbourPairs neighbours(made);
  neighbours.add_all(model.vertex_count());
  neighbours.sort(model);
  return made;
}

}  // namespace clothlab::sim
