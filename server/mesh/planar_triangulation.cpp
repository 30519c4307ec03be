#include "server/mesh/planar_triangulation.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <utility>

namespace clothlab::mesh {

namespace {

/// A point this near an edge, as a share of its length, is on it.
constexpr double on_edge = 1e-9;

/// Above 0 if d is within the circle of a, b and c, as a share of lengths to the fourth power.
double in_circle(const dvec2& a, const dvec2& b, const dvec2& c, const dvec2& d) {
  const dvec2 u = a - d, v = b - d, w = c - d;
  const double uu = glm::dot(u, u), vv = glm::dot(v, v), ww = glm::dot(w, w), most = std::max({uu, vv, ww});
  const double sum =
      uu * (v.x * w.y - v.y * w.x) - vv * (u.x * w.y - u.y * w.x) + ww * (u.x * v.y - u.y * v.x);
  return sum / (most * most);
}

bool cross(const dvec2& a, const dvec2& b, const dvec2& c, const dvec2& d) {
  return doubled_area(a, b, c) * doubled_area(a, b, d) < 0.0 &&
         doubled_area(c, d, a) * doubled_area(c, d, b) < 0.0;
}

}  // namespace

double least_sine(const dvec2& a, const dvec2& b, const dvec2& c) {
  const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
  return doubled_area(a, b, c) / std::max({ab * bc, bc * ca, ca * ab});
}

PlanarTriangulation::PlanarTriangulation(const dvec2& low, const dvec2& high) {
  const dvec2 middle = 0.5 * (low + high);
  const double far = 20.0 * std::max(high.x - low.x, high.y - low.y);
  points_ = {middle + dvec2(-far, -far), middle + dvec2(far, -far), middle + dvec2(0.0, far)};
  triangles_.push_back({{0, 1, 2}});
  at_.assign(3, 0);
  held_.assign(3, 1);
}

std::size_t PlanarTriangulation::corner_of(std::uint32_t triangle, std::uint32_t point) const {
  const auto& corners = triangles_[triangle].corners;
  return static_cast<std::size_t>(std::find(corners.begin(), corners.end(), point) - corners.begin());
}

std::size_t PlanarTriangulation::side_towards(std::uint32_t triangle, std::uint32_t other) const {
  const auto& beside = triangles_[triangle].beside;
  return static_cast<std::size_t>(std::find(beside.begin(), beside.end(), other) - beside.begin());
}

std::uint32_t PlanarTriangulation::find(const dvec2& point) const {
  std::uint32_t at = last_;
  for (std::size_t step = 0; step < triangles_.size(); ++step) {
    const Triangle& here = triangles_[at];
    std::size_t side = 3;
    double farthest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec2 &a = points_[here.corners[(k + 1) % 3]], &b = points_[here.corners[(k + 2) % 3]];
      const double beyond = -doubled_area(a, b, point) / glm::dot(b - a, b - a);
      if (beyond > std::max(farthest, on_edge)) farthest = beyond, side = k;
    }
    if (side == 3 || here.beside[side] == none) break;
    at = here.beside[side];
  }
  return last_ = at;
}

void PlanarTriangulation::connect(std::uint32_t triangle, std::size_t side, std::uint32_t other,
                                  bool required) {
  triangles_[triangle].beside[side] = other;
  triangles_[triangle].required[side] = required;
  for (std::size_t k = 0; k < 3; ++k) at_[triangles_[triangle].corners[k]] = triangle;
}

void PlanarTriangulation::split(std::uint32_t triangle, std::uint32_t point) {
  const Triangle old = triangles_[triangle];
  const auto more = static_cast<std::uint32_t>(triangles_.size());
  const std::array<std::uint32_t, 3> parts{triangle, more, more + 1};  // part k: across from corner k
  triangles_.resize(triangles_.size() + 2);
  for (std::size_t k = 0; k < 3; ++k)
    triangles_[parts[k]].corners = {point, old.corners[(k + 1) % 3], old.corners[(k + 2) % 3]};
  for (std::size_t k = 0; k < 3; ++k) {
    if (old.beside[k] != none) {
      const std::size_t back = side_towards(old.beside[k], triangle);
      triangles_[old.beside[k]].beside[back] = parts[k];
    }
    connect(parts[k], 0, old.beside[k], old.required[k]);
    connect(parts[k], 1, parts[(k + 1) % 3], false);
    connect(parts[k], 2, parts[(k + 2) % 3], false);
  }
}

std::uint32_t PlanarTriangulation::add(const dvec2& point) {
  const std::uint32_t triangle = find(point);
  const auto number = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
  at_.push_back(triangle);
  held_.push_back(0);
  const std::array<std::uint32_t, 3> parts{triangle, static_cast<std::uint32_t>(triangles_.size()),
                                           static_cast<std::uint32_t>(triangles_.size() + 1)};
  split(triangle, number);
  for (const std::uint32_t part : parts) {  // a point on an edge: the triangle without area goes
    const auto& [self, a, b] = triangles_[part].corners;
    if (std::abs(doubled_area(point, points_[a], points_[b])) >
        on_edge * glm::dot(points_[b] - points_[a], points_[b] - points_[a]))
      continue;
    if (triangles_[part].beside[0] != none && !triangles_[part].required[0]) flip(part, 0);
    break;
  }
  restore({parts.begin(), parts.end()});
  return number - 3;
}

bool PlanarTriangulation::can_flip(std::uint32_t triangle, std::size_t side) const {
  const Triangle& here = triangles_[triangle];
  if (here.beside[side] == none || here.required[side]) return false;
  const Triangle& there = triangles_[here.beside[side]];
  const dvec2& own = points_[here.corners[side]];
  const dvec2& far = points_[there.corners[side_towards(here.beside[side], triangle)]];
  const dvec2 &a = points_[here.corners[(side + 1) % 3]], &b = points_[here.corners[(side + 2) % 3]];
  return doubled_area(own, a, far) > 0.0 && doubled_area(own, far, b) > 0.0;
}

bool PlanarTriangulation::should_flip(std::uint32_t triangle, std::size_t side) const {
  constexpr double rounding = 1e-12;
  if (!can_flip(triangle, side)) return false;
  const Triangle& here = triangles_[triangle];
  const Triangle& there = triangles_[here.beside[side]];
  const dvec2& far = points_[there.corners[side_towards(here.beside[side], triangle)]];
  return in_circle(points_[here.corners[0]], points_[here.corners[1]], points_[here.corners[2]], far) >
         rounding;
}

/// The edge across from a corner becomes the one from that corner to the one beyond.
void PlanarTriangulation::flip(std::uint32_t triangle, std::size_t side) {
  const std::uint32_t other = triangles_[triangle].beside[side];
  const std::size_t back = side_towards(other, triangle);
  const Triangle here = triangles_[triangle], there = triangles_[other];
  const std::size_t next = (side + 1) % 3, last = (side + 2) % 3;
  const std::uint32_t own = here.corners[side], far = there.corners[back];
  // `there` has the edge the other way round: its corner after `back` is here.corners[last].
  const std::size_t there_next = (back + 1) % 3, there_last = (back + 2) % 3;
  triangles_[triangle].corners = {own, here.corners[next], far};
  triangles_[other].corners = {own, far, here.corners[last]};
  const auto take = [&](std::uint32_t to, std::size_t at, const Triangle& from, std::size_t was,
                        std::uint32_t before) {
    if (from.beside[was] != none)
      triangles_[from.beside[was]].beside[side_towards(from.beside[was], before)] = to;
    connect(to, at, from.beside[was], from.required[was]);
  };
  take(triangle, 0, there, there_next, other);
  take(triangle, 2, here, last, triangle);
  take(other, 0, there, there_last, other);
  take(other, 1, here, next, triangle);
  connect(triangle, 1, other, false);
  connect(other, 2, triangle, false);
}

void PlanarTriangulation::restore(std::vector<std::uint32_t> changed) {
  while (!changed.empty()) {
    const std::uint32_t triangle = changed.back();
    changed.pop_back();
    for (std::size_t side = 0; side < 3; ++side) {
      if (!should_flip(triangle, side)) continue;
      const std::uint32_t other = triangles_[triangle].beside[side];
      flip(triangle, side);
      changed.insert(changed.end(), {triangle, other});
      break;
    }
  }
}

std::vector<std::uint32_t> PlanarTriangulation::around(std::uint32_t point) const {
  std::vector<std::uint32_t> found;
  for (std::uint32_t at = at_[point]; at != none && (found.empty() || at != found.front());) {
    found.push_back(at);
    at = triangles_[at].beside[(corner_of(at, point) + 1) % 3];
  }
  return found;
}

bool PlanarTriangulation::require(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t a = first + 3, b = second + 3;
  held_[a] = held_[b] = 1;
  using Edge = std::array<std::uint32_t, 2>;
  /// The triangle in which the edge goes from its first point to its second, and the side.
  const auto locate = [&](const Edge& edge) -> std::pair<std::uint32_t, std::size_t> {
    for (const std::uint32_t at : around(edge[0])) {
      const std::size_t corner = corner_of(at, edge[0]);
      if (triangles_[at].corners[(corner + 1) % 3] == edge[1]) return {at, (corner + 2) % 3};
    }
    return {none, 0};
  };
  std::deque<Edge> crossing;
  for (std::uint32_t at : around(a)) {
    std::size_t side = corner_of(at, a);
    const auto ends = [&] {
      return Edge{triangles_[at].corners[(side + 1) % 3], triangles_[at].corners[(side + 2) % 3]};
    };
    if (!cross(points_[a], points_[b], points_[ends()[0]], points_[ends()[1]])) continue;
    for (;;) {  // along the way from a to b
      if (triangles_[at].required[side]) return false;
      crossing.push_back(ends());
      const std::uint32_t next = triangles_[at].beside[side];
      const std::size_t back = side_towards(next, at);
      at = next;
      if (triangles_[at].corners[back] == b) break;
      side = (back + 1) % 3;
      if (!cross(points_[a], points_[b], points_[ends()[0]], points_[ends()[1]])) side = (back + 2) % 3;
      if (!cross(points_[a], points_[b], points_[ends()[0]], points_[ends()[1]]))
        return false;  // a point is on it
    }
    break;
  }
  std::vector<std::uint32_t> changed;
  for (std::size_t tries = 0; !crossing.empty(); ++tries) {
    if (tries > 64 * (crossing.size() + 64)) return false;
    const Edge edge = crossing.front();
    crossing.pop_front();
    const auto [at, side] = locate(edge);
    if (at == none || !can_flip(at, side)) {
      crossing.push_back(edge);
      continue;
    }
    const std::uint32_t other = triangles_[at].beside[side], own = triangles_[at].corners[side];
    const std::uint32_t far = triangles_[other].corners[side_towards(other, at)];
    flip(at, side);
    changed.insert(changed.end(), {at, other});
    if (cross(points_[a], points_[b], points_[own], points_[far])) crossing.push_back({own, far});
  }
  const auto [at, side] = locate({a, b});
  const auto [beside, other_side] = locate({b, a});
  if (at == none || beside == none) return false;
  triangles_[at].required[side] = triangles_[beside].required[other_side] = true;
  restore(std::move(changed));
  return true;
}

/// Moves a point if the least angle around it gets larger.
bool PlanarTriangulation::improve(std::uint32_t point) {
  const std::vector<std::uint32_t> star = around(point);
  dvec2 sum(0.0);
  double weight = 0.0;
  const auto worst = [&] {
    double least = 1.0;
    for (const std::uint32_t at : star) {
      const auto& [a, b, c] = triangles_[at].corners;
      least = std::min(least, least_sine(points_[a], points_[b], points_[c]));
    }
    return least;
  };
  for (const std::uint32_t at : star) {
    const auto& [a, b, c] = triangles_[at].corners;
    const double area = doubled_area(points_[a], points_[b], points_[c]);
    sum += area / 3.0 * (points_[a] + points_[b] + points_[c]);
    weight += area;
  }
  const dvec2 before = points_[point];
  const double least = worst();
  if (!(weight > 0.0)) return false;
  points_[point] = sum / weight;
  if (worst() >= least) return true;
  points_[point] = before;
  return false;
}

void PlanarTriangulation::smooth(int rounds) {
  std::vector<std::uint32_t> all(triangles_.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  for (int round = 0; round < rounds; ++round) {
    for (std::uint32_t point = 3; point < points_.size(); ++point)
      if (!held_[point]) improve(point);
    restore(all);
  }
}

std::vector<std::array<std::uint32_t, 3>> PlanarTriangulation::inside() const {
  std::vector<signed char> within(triangles_.size(), -1);
  std::vector<std::uint32_t> open{at_[0]};
  within[at_[0]] = 0;
  std::vector<std::array<std::uint32_t, 3>> result;
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    const Triangle& here = triangles_[at];
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t next = here.beside[side];
      if (next == none || within[next] >= 0) continue;
      within[next] = static_cast<signed char>(here.required[side] ? 1 - within[at] : within[at]);
      open.push_back(next);
    }
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    if (within[i] == 1) {
      const auto& [a, b, c] = triangles_[i].corners;
      result.push_back({a - 3, b - 3, c - 3});
    }
  return result;
}

}  // namespace clothlab::mesh
