#include "server/model/crossings.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "server/base/pieces.h"
#include "server/model/box_tree.h"
#include "server/model/orientation.h"

namespace clothlab::model {

namespace {

/// True if a line of the projection certainly lies between the segment and the triangle.
bool surely_apart(const dvec3& p, const dvec3& q, const std::array<dvec3, 3>& corner, Projection on) {
  const int first = sure_turn(p, q, corner[0], on);
  if (first != 0 && first == sure_turn(p, q, corner[1], on) && first == sure_turn(p, q, corner[2], on))
    return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 &a = corner[i], &b = corner[(i + 1) % 3], &c = corner[(i + 2) % 3];
    const int beyond = -sure_turn(a, b, c, on);
    if (beyond != 0 && sure_turn(a, b, p, on) == beyond && sure_turn(a, b, q, on) == beyond) return true;
  }
  return false;
}

bool ranges_overlap(double p, double q, double a, double b) {
  return std::max(p, q) >= std::min(a, b) && std::max(a, b) >= std::min(p, q);
}

/// True if the projections of the segments p q and a b have a point in common.
bool segments_meet(const dvec3& p, const dvec3& q, const dvec3& a, const dvec3& b, Projection on) {
  for (const int axis : on)
    if (!ranges_overlap(p[axis], q[axis], a[axis], b[axis])) return false;
  return turn(p, q, a, on) * turn(p, q, b, on) <= 0 && turn(a, b, p, on) * turn(a, b, q, on) <= 0;
}

/// True if the projections of the segment p q and the triangle have a point in common.
bool meet_in_projection(const dvec3& p, const dvec3& q, const std::array<dvec3, 3>& corner, Projection on) {
  const auto& [a, b, c] = corner;
  if (segments_meet(p, q, a, b, on) || segments_meet(p, q, b, c, on) || segments_meet(p, q, c, a, on))
    return true;
  const int inside = turn(a, b, c, on);  // no side is met: both ends are inside, or none
  return inside != 0 && turn(a, b, p, on) == inside && turn(b, c, p, on) == inside &&
         turn(c, a, p, on) == inside;
}

/// The same of five points in one plane. Along at least one axis no two points of it are projected onto one.
bool meet_in_plane(const dvec3& p, const dvec3& q, const std::array<dvec3, 3>& corner) {
  return std::all_of(projections.begin(), projections.end(),
                     [&](Projection on) { return meet_in_projection(p, q, corner, on); });
}

/// A point of the segment p q, at or near where it meets the triangle.
dvec3 meeting_place(const dvec3& p, const dvec3& q, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 normal = glm::cross(b - a, c - a), along = q - p;
  const double from = glm::dot(normal, p - a), to = glm::dot(normal, q - a);
  double share = from / (from - to);
  if (!(share >= 0.0 && share <= 1.0))  // in one plane: the point nearest the triangle's middle
    share = glm::dot((a + b + c) / 3.0 - p, along) / glm::dot(along, along);
  return share >= 0.0 ? p + std::min(share, 1.0) * along : p;  // not so for a segment of no length, too
}

}  // namespace

bool meets(const dvec3& p, const dvec3& q, const dvec3& a, const dvec3& b, const dvec3& c) {
  const std::array corner{a, b, c};
  for (const Projection on : projections)
    if (surely_apart(p, q, corner, on)) return false;
  const int of_p = side(a, b, c, p), of_q = side(a, b, c, q);
  if (of_p * of_q > 0) return false;
  const int ab = side(p, q, a, b), bc = side(p, q, b, c), ca = side(p, q, c, a);
  // Both in the triangle's plane; or the triangle has no area, and the segment may pass its line at a
  // distance.
  if (of_p == 0 && of_q == 0) return ab == 0 && bc == 0 && ca == 0 && meet_in_plane(p, q, corner);
  // The segment goes through the plane in one point, which is not on the wrong side of any of the triangle's
  // sides.
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

std::vector<dvec3> as_floats(const std::vector<dvec3>& x) {
  std::vector<dvec3> rounded;
  rounded.reserve(x.size());
  for (const dvec3& each : x) rounded.emplace_back(glm::vec3(each));
  return rounded;
}

Surfaces surfaces_of(const Model& model, Bodies bodies) {
  Surfaces surfaces{model.triangles, {}, model.vertex_count()};
  for (const BodyRange& body : model.bodies) {
    if (bodies == Bodies::none || (body.box && bodies == Bodies::meshes)) continue;
    const auto first = model.body_triangles.begin() + body.first_triangle;
    surfaces.triangles.insert(surfaces.triangles.end(), first, first + body.triangle_count);
  }
  for (const auto& [a, b, c] : surfaces.triangles)
    for (const auto& [p, q] : {std::array{a, b}, {b, c}, {c, a}})
      surfaces.edges.push_back({std::min(p, q), std::max(p, q)});
  between_pieces();
  std::sort(surfaces.edges.begin(), surfaces.edges.end());
  surfaces.edges.erase(std::unique(surfaces.edges.begin(), surfaces.edges.end()), surfaces.edges.end());
  return surfaces;
}

Crossings find_crossings(const Surfaces& surfaces, const std::vector<dvec3>& x, CrossingLimits limits) {
  std::vector<Bounds> boxes;
  boxes.reserve(surfaces.triangles.size());
  for (const auto& [a, b, c] : surfaces.triangles)
    boxes.push_back({glm::min(x[a], glm::min(x[b], x[c])), glm::max(x[a], glm::max(x[b], x[c]))});
  between_pieces();
  const BoxTree tree(boxes);
  Crossings found;
  std::vector<std::uint32_t> near;
  Pieces pieces;
  for (const auto& [i, j] : surfaces.edges) {
    pieces.next();
    near.clear();
    tree.overlapping({glm::min(x[i], x[j]), glm::max(x[i], x[j])}, near);
    std::sort(near.begin(), near.end());
    for (const std::uint32_t index : near) {
      const auto& [a, b, c] = surfaces.triangles[index];
      if (i == a || i == b || i == c || j == a || j == b || j == c) continue;
      const bool body_edge = i >= surfaces.first_body_vertex, body = a >= surfaces.first_body_vertex;
      if (body_edge && body) continue;
      if (!surfaces.among_cloths && !body_edge && !body) continue;
      if (!meets(x[i], x[j], x[a], x[b], x[c])) continue;
      if (found.first.size() < limits.named)
        found.first.push_back({{i, j}, {a, b, c}, meeting_place(x[i], x[j], x[a], x[b], x[c])});
      if (++found.count < limits.counted) continue;
      found.complete = false;
      return found;
    }
  }
  return found;
}

}  // namespace clothlab::model
