#include "server/model/skin.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <set>

#include "server/base/pieces.h"
#include "server/model/motion.h"
#include "server/model/triangle_geometry.h"
#include "server/scene/solid.h"
#include "shaders/elements/elements.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;
using Corners = std::array<Index, 3>;

/// So far off the middle of a face, over its size, is looked at what is on either side of it.
constexpr double beside_face = 1e-3;
constexpr double growth = 0.05;       // of the mean edge: what a crossing that comes again is pushed farther
constexpr double most_farther = 0.5;  // of the mean edge

}  // namespace

SolidThere solid_at_start(const scene::Collider& collider, double clearance) {
  const scene::Solid home = scene::solid(collider.shape);
  const Pose now = pose(collider.motion, 0.0);
  return {home.kind,
          {now.place(home.point), now.rotation * home.direction, home.radius + clearance,
           now.rotation * home.second, home.extent}};
}

Skin::Skin(const Model& model, const scene::Scene& scene, const std::vector<dvec3>& x, double clearance)
    : first_(model.vertex_count()), x_(x), clearance_(clearance) {
  for (Index body = 0; body < model.bodies.size(); ++body)
    if (!model.bodies[body].box) insides_.push_back(std::make_unique<BodyInside>(model, body, x));
  for (Index body = 0; body < model.bodies.size(); ++body) {
    if (model.bodies[body].box) continue;
    between_pieces();
    add_faces(model, body);
  }
  for (const bool open : {false, true}) {
    for (const Face& face : faces_[open]) {
      const auto [a, b, c] = corners_of(face);
      boxes_[open].push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    }
    trees_[open] = std::make_unique<BoxTree>(boxes_[open]);
  }
  for (const scene::Collider& collider : scene.colliders)
    if (!collider.is_body()) solids_.push_back(solid_at_start(collider, clearance));
}

std::array<dvec3, 3> Skin::corners_of(const Face& face) const {
  return {at(face.corners[0]), at(face.corners[1]), at(face.corners[2])};
}

/// Parts that overlap are one body: of closed ones a face is met where it has the inside on one side only.
void Skin::add_faces(const Model& model, Index body) {
  const BodyRange& range = model.bodies[body];
  const std::vector<BodyPart> parts = parts_of(model, body);
  std::map<std::array<Index, 2>, int> at_edge;
  std::map<Index, Index> number;  // of open parts
  for (Index t = 0; t < range.triangle_count; ++t) {
    const Corners& corners = model.body_triangles[range.first_triangle + t];
    for (std::size_t k = 0; k < 3; ++k) ++at_edge[in_order(corners[k], corners[(k + 1) % 3])];
  }
  Pieces pieces;
  for (Index t = 0; t < range.triangle_count; ++t) {
    pieces.next();
    Face face{model.body_triangles[range.first_triangle + t], dvec3(0.0), not_open, {}};
    const std::array<dvec3, 3> corner = corners_of(face);
    face.normal = normal_of(corner);
    const bool open = parts[t].open;
    if (open) {
      const auto [of, fresh] = number.try_emplace(parts[t].number, static_cast<Index>(sides_.size()));
      if (fresh) sides_.push_back(1.0);
      face.part = of->second;
      for (std::size_t k = 0; k < 3; ++k)
        face.border[k] = at_edge[in_order(face.corners[k], face.corners[(k + 1) % 3])] == 1;
    } else {
      const dvec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
      const dvec3 step = face.normal * (beside_face * glm::distance(corner[0], middle));
      const bool before = contained(middle + step), behind = contained(middle - step);
      if (before == behind) continue;
      if (before) face.normal = -face.normal;
    }
    by_corners_[face.corners] = face;
    faces_[open].push_back(face);
    for (std::size_t k = 0; k < 3; ++k)
      at_edge_[in_order(face.corners[k], face.corners[(k + 1) % 3])].push_back(face);
  }
}

bool Skin::contained(const dvec3& point) const {
  return std::any_of(insides_.begin(), insides_.end(),
                     [&](const auto& inside) { return inside->contains(point); });
}

bool Skin::nearest(const dvec3& point, double reach, bool open, Nearest& found) const {
  std::vector<Index> near;
  trees_[open]->overlapping({point - reach, point + reach}, near);
  std::sort(near.begin(), near.end());
  found.distance = reach;
  bool any = false;
  for (const Index index : near) {
    const Face& face = faces_[open][index];
    const PlaceOnTriangle here = nearest_place(corners_of(face), point);
    const double distance = glm::distance(here.place, point);
    if (distance > found.distance * (1.0 + 1e-9) + no_distance) continue;
    const bool same = any && distance >= found.distance * (1.0 - 1e-9) - no_distance;  // an edge or a corner
    if (!same) found = {distance, here.place, dvec3(0.0), false, face.part};
    any = true;
    found.normal += face.normal;
    for (std::size_t k = 0; k < 3; ++k)
      found.border = found.border || (face.border[k] && here.shares[static_cast<int>((k + 2) % 3)] <= 0.0);
  }
  return any;
}

void Skin::choose_sides(const DressCloth& cloth) {
  farther_.assign(cloth.x.size(), 0.0);
  inside_.assign(cloth.x.size(), false);
  reach_ = 2.0 * std::max(clearance_, cloth.mean_edge());
  Pieces pieces;
  for (Index i = 0; i < cloth.x.size(); ++i) {
    pieces.next();
    inside_[i] = cloth.moves(i) && contained(cloth.x[i]);
  }
  if (faces_[true].empty()) return;
  std::vector<double> balance(sides_.size(), 0.0);
  for (const dvec3& x : cloth.x) {
    pieces.next();
    Nearest found;
    for (double reach = reach_; reach < 16.0 * reach_; reach *= 2.0) {
      if (!nearest(x, reach, true, found)) continue;
      if (!found.border) balance[found.part] += glm::dot(x - found.place, found.normal) > 0.0 ? 1.0 : -1.0;
      break;
    }
  }
  for (std::size_t i = 0; i < sides_.size(); ++i) sides_[i] = balance[i] < 0.0 ? -1.0 : 1.0;
}

/// True if the vertex is inside.
bool Skin::demand_of(const DressCloth& cloth, Index vertex, std::vector<Demand>& demands) {
  const dvec3& x = cloth.x[vertex];
  const double free = clearance_ + farther_[vertex];
  bool is_inside = false;
  for (const bool open : {false, true}) {
    if (faces_[open].empty()) continue;
    Nearest found;
    bool near = nearest(x, reach_, open, found);
    bool behind = false;
    if (!open) {
      if (!near && !inside_[vertex]) continue;
      behind = inside_[vertex] = contained(x);
      if (behind)
        for (double reach = 2.0 * reach_; !near && reach < 1e4 * reach_; reach *= 2.0)
          near = nearest(x, reach, open, found);
    } else if (near) {
      if (found.border) continue;
      behind = sides_[found.part] * glm::dot(x - found.place, found.normal) < 0.0;
    }
    if (!near || (!behind && found.distance >= free)) continue;
    dvec3 out = behind ? found.place - x : x - found.place;
    const double length = glm::length(out), by_normal = glm::length(found.normal);
    if (length > no_distance)
      out /= length;
    else if (by_normal > 0.0)
      out = found.normal / by_normal * (open ? sides_[found.part] : 1.0);
    else
      continue;
    demands.push_back({{vertex}, {1.0}, out, glm::dot(out, found.place) + free});
    is_inside = is_inside || behind;
  }
  return is_inside;
}

/// True if the vertex is inside.
bool Skin::demand_of_solids(const DressCloth& cloth, Index vertex, std::vector<Demand>& demands) const {
  const dvec3& x = cloth.x[vertex];
  bool is_inside = false;
  for (const SolidThere& each : solids_) {
    dvec3 normal;
    const double depth = elements::nearest_of_solid(each.kind, each.solid, x, normal);
    if (depth > 0.0) demands.push_back({{vertex}, {1.0}, normal, glm::dot(normal, x) + depth});
    is_inside = is_inside || depth > clearance_;
  }
  return is_inside;
}

std::size_t Skin::demand_outside(const DressCloth& cloth, std::vector<Demand>& demands) {
  std::size_t inside = 0;
  Pieces pieces;
  for (Index i = 0; i < cloth.x.size(); ++i) {
    pieces.next();
    if (!cloth.moves(i)) continue;
    const bool in_body = demand_of(cloth, i, demands), in_solid = demand_of_solids(cloth, i, demands);
    if (in_body || in_solid) ++inside;
  }
  return inside;
}

void Skin::demand_apart(const DressCloth& cloth, const std::vector<Crossing>& crossings,
                        std::vector<Demand>& demands) {
  const double more = growth * cloth.mean_edge(), most = most_farther * cloth.mean_edge();
  std::set<Index> pushed;
  for (const Crossing& each : crossings) {
    const bool body_edge = each.edge[0] >= first_;
    if (!body_edge && each.triangle[0] < first_) continue;
    if (body_edge)
      pushed.insert(each.triangle.begin(), each.triangle.end());
    else
      pushed.insert(each.edge.begin(), each.edge.end());
    dvec3 out(0.0);
    double height = 0.0;
    if (body_edge) {
      const auto faces = at_edge_.find(each.edge);
      if (faces == at_edge_.end()) continue;
      for (const Face& face : faces->second) out += outwards(face);
    } else {
      const auto face = by_corners_.find(each.triangle);
      if (face == by_corners_.end()) continue;
      out = outwards(face->second);
    }
    if (!(glm::length(out) > no_distance)) continue;
    out = glm::normalize(out);
    Demand demand{{}, {}, out, 0.0};
    if (body_edge) {
      for (const Index end : each.edge) height = std::max(height, glm::dot(out, at(end) - each.place));
      const std::array corner{cloth.x[each.triangle[0]], cloth.x[each.triangle[1]],
                              cloth.x[each.triangle[2]]};
      const dvec3 shares = nearest_place(corner, each.place).shares;
      for (std::size_t k = 0; k < 3; ++k) {
        demand.vertices[k] = each.triangle[k];
        demand.shares[k] = shares[static_cast<int>(k)];
      }
    } else {
      const dvec3 &p = cloth.x[each.edge[0]], &q = cloth.x[each.edge[1]];
      const double length = glm::distance(p, q);
      const double share = length > 0.0 ? std::min(glm::distance(p, each.place) / length, 1.0) : 0.5;
      demand.vertices = {each.edge[0], each.edge[1]};
      demand.shares = {1.0 - share, share};
    }
    demand.least = glm::dot(out, each.place) + height + clearance_;
    demands.push_back(demand);
  }
  for (const Index vertex : pushed) farther_[vertex] = std::min(farther_[vertex] + more, most);
}

/// The face's normal, to the side on which cloth is.
dvec3 Skin::outwards(const Face& face) const {
  return face.part == not_open ? face.normal : sides_[face.part] * face.normal;
}

}  // namespace clothlab::model
