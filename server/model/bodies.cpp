#include "server/model/bodies.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <tuple>

#include "server/base/disjoint_sets.h"
#include "server/model/motion.h"
#include "server/model/orientation.h"
#include "server/scene/placement.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;
using Corners = std::array<Index, 3>;

/// A side of a triangle.
struct Side {
  Index low, high;
  int direction;  ///< 1: the triangle goes from `low` to `high`; else -1
  bool operator<(const Side& other) const { return std::tie(low, high) < std::tie(other.low, other.high); }
};

}  // namespace

std::vector<BodyPart> parts_of(const Model& model, std::uint32_t number) {
  const BodyRange& body = model.bodies[number];
  const Corners* first = model.body_triangles.data() + body.first_triangle;
  DisjointSets joined(body.vertex_count);
  const auto number_in_body = [&](Index vertex) { return vertex - model.vertex_count() - body.first_vertex; };
  const auto part = [&](Index vertex) { return joined.find(number_in_body(vertex)); };
  std::vector<Side> sides;
  sides.reserve(3 * std::size_t{body.triangle_count});
  for (Index t = 0; t < body.triangle_count; ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Index a = first[t][corner], b = first[t][(corner + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
      joined.join(number_in_body(a), number_in_body(b));
    }
  std::sort(sides.begin(), sides.end());
  std::vector<bool> open(body.vertex_count, false);  // by the part's root
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    int balance = 0;
    for (end = begin; end < sides.size() && !(sides[begin] < sides[end]); ++end)
      balance += sides[end].direction;
    if (balance != 0) open[part(sides[begin].low)] = true;
  }
  std::vector<BodyPart> parts;
  parts.reserve(body.triangle_count);
  for (Index t = 0; t < body.triangle_count; ++t) {
    const Index of = part(first[t][0]);
    parts.push_back({of, open[of]});
  }
  return parts;
}

namespace {

/// How often the border of a triangle winds around the point, seen along x: 1, 0 or -1. A point on a side
/// counts to one of the two triangles there: that to which the side, gone upwards, lies to the left of it.
int winding_seen_along_x(const std::array<dvec3, 3>& corner, const dvec3& point) {
  constexpr Projection on{1, 2};
  int winding = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 &a = corner[i], &b = corner[(i + 1) % 3];
    const bool upwards = a.z <= point.z && point.z < b.z, downwards = b.z <= point.z && point.z < a.z;
    if (upwards && turn(a, b, point, on) > 0) ++winding;
    if (downwards && turn(b, a, point, on) > 0) --winding;
  }
  return winding;
}

/// The corners of the triangles of closed parts.
std::vector<std::array<dvec3, 3>> placed_corners(const Model& model, std::uint32_t number,
                                                 const std::vector<dvec3>& position) {
  std::vector<std::array<dvec3, 3>> placed;
  const Index first = model.vertex_count();
  const std::vector<BodyPart> parts = parts_of(model, number);
  for (std::size_t t = 0; t < parts.size(); ++t) {
    if (parts[t].open) continue;
    const auto& [a, b, c] = model.body_triangles[model.bodies[number].first_triangle + t];
    placed.push_back({position[a - first], position[b - first], position[c - first]});
  }
  return placed;
}

std::vector<Bounds> boxes_of(const std::vector<std::array<dvec3, 3>>& triangles) {
  std::vector<Bounds> boxes;
  boxes.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  return boxes;
}

void add_body(Model& model, const scene::Collider& collider, Index number, const std::vector<dvec3>& vertices,
              const std::vector<Corners>& triangles) {
  const Index first = model.body_vertex_count();
  model.bodies.push_back({number, first, static_cast<Index>(vertices.size()),
                          static_cast<Index>(model.body_triangles.size()),
                          static_cast<Index>(triangles.size()), collider.motion,
                          std::holds_alternative<scene::Box>(collider.shape)});
  const Index from = model.vertex_count() + first;
  for (const auto& [a, b, c] : triangles) model.body_triangles.push_back({a + from, b + from, c + from});
  model.body_position.insert(model.body_position.end(), vertices.begin(), vertices.end());
  model.vertex_body.resize(model.body_position.size(), static_cast<Index>(model.bodies.size() - 1));
}

/// Corner k of a box is on the far side of axis i where bit i of k is set.
std::vector<dvec3> corners_of(const scene::Box& box) {
  std::vector<dvec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(box.center +
                      box.axes * (box.half * dvec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
  return corners;
}

/// Two of each face, counter-clockwise seen from outside.
constexpr std::array<Corners, 12> box_triangles{{{0, 4, 6},
                                                 {0, 6, 2},
                                                 {1, 3, 7},
                                                 {1, 7, 5},
                                                 {0, 1, 5},
                                                 {0, 5, 4},
                                                 {2, 6, 7},
                                                 {2, 7, 3},
                                                 {0, 2, 3},
                                                 {0, 3, 1},
                                                 {4, 5, 7},
                                                 {4, 7, 6}}};

}  // namespace

bool has_edges(const scene::Scene& scene, const scene::Collider& collider) {
  return scene.collides(scene::ContactKind::surface) && std::holds_alternative<scene::Box>(collider.shape) &&
         !scene::has_motion(collider.motion);
}

void add_bodies(Model& model, const scene::Scene& scene) {
  for (Index i = 0; i < scene.colliders.size(); ++i) {
    const scene::Collider& collider = scene.colliders[i];
    if (const auto* body = std::get_if<scene::Body>(&collider.shape))
      add_body(model, collider, i, scene::placed(body->transform, body->mesh->vertices),
               body->mesh->triangles);
    else if (has_edges(scene, collider))
      add_body(model, collider, i, corners_of(std::get<scene::Box>(collider.shape)),
               {box_triangles.begin(), box_triangles.end()});
  }
}

std::vector<dvec3> body_positions(const Model& model, double time) {
  std::vector<dvec3> position = model.body_position;
  for (const BodyRange& body : model.bodies) {
    const Pose now = pose(body.motion, time);
    const auto first = position.begin() + body.first_vertex;
    std::transform(first, first + body.vertex_count, first,
                   [&](const dvec3& home) { return now.place(home); });
  }
  return position;
}

BodyInside::BodyInside(const Model& model, std::uint32_t body, const std::vector<dvec3>& position)
    : triangles_(placed_corners(model, body, position)),
      boxes_(boxes_of(triangles_)),
      tree_(boxes_),
      farthest_(std::numeric_limits<double>::lowest()) {
  for (const Bounds& box : boxes_) farthest_ = std::max(farthest_, box.high.x);
}

bool BodyInside::contains(const dvec3& point) const {
  if (!(point.x <= farthest_)) return false;
  std::vector<std::uint32_t> met;
  tree_.overlapping({point, {farthest_, point.y, point.z}}, met);
  int winding = 0;
  for (const std::uint32_t index : met) {
    const std::array<dvec3, 3>& corner = triangles_[index];
    const int seen = winding_seen_along_x(corner, point);
    // The triangle's front looks along x where its border turns to the left: the point is before it if it is
    // behind it.
    if (seen != 0 && seen * side(corner[0], corner[1], corner[2], point) < 0) winding += seen;
  }
  return winding != 0;
}

}  // namespace clothlab::model
