#include "server/film/bodies.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>
#include <variant>

#include "server/scene/document.h"
#include "server/scene/placement.h"
#include "server/scene/solid.h"

namespace clothlab::film {

namespace {

using glm::dquat;
using glm::dvec3;
using nlohmann::json;

/// Stands for a body's mesh where its file may not be at hand.
const json any_mesh = {{"vertices", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                       {"triangles", {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};

/// The colliders as the document of a scene says them, checked as such a one is.
Result<std::vector<scene::Collider>> checked(json colliders) {
  const json cloth{{"mesh", {{"grid", {{"columns", 2}, {"rows", 2}}}}}};
  Result<scene::Document> document = scene::validate(
      {{"version", 1}, {"cloths", json::array({cloth})}, {"colliders", std::move(colliders)}});
  if (!document) return document.error();
  return std::move(document->scene.colliders);
}

/// The least turn that takes one direction to another.
dquat least_turn(const dvec3& from, const dvec3& to) {
  const double together = glm::dot(from, to);
  if (together < -1.0 + 1e-9) {  // back to front: about any axis across
    const dvec3 other = std::abs(from.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    return {0.0, glm::normalize(glm::cross(from, other))};
  }
  return glm::normalize(dquat(1.0 + together, glm::cross(from, to)));
}

Form form_of(const scene::Shape& shape, double half_length) {
  if (const auto* capsule = std::get_if<scene::Capsule>(&shape))
    return {Form::Kind::capsule, capsule->radius, 0.5 * glm::distance(capsule->a, capsule->b)};
  if (std::holds_alternative<scene::Box>(shape)) return {Form::Kind::box};
  if (std::holds_alternative<scene::Plane>(shape)) return {Form::Kind::square, 1.0, half_length};
  if (const auto* body = std::get_if<scene::Body>(&shape)) return {Form::Kind::mesh, 1.0, 1.0, body->mesh};
  return {};
}

/// A capsule that moves has the same length but for rounding.
bool same(const Form& a, const Form& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) <= 1e-6 * std::max(1.0, std::abs(y)); };
  if (a.kind != b.kind || !near(a.radius, b.radius) || !near(a.half_length, b.half_length)) return false;
  return a.mesh == b.mesh || (a.mesh && b.mesh && *a.mesh == *b.mesh);
}

}  // namespace

bool Body::moves() const {
  return std::any_of(poses.begin(), poses.end(), [&](const auto& pose) { return pose != poses.front(); });
}

bool Body::always_there() const {
  return std::all_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); });
}

Result<std::vector<scene::Collider>> colliders_of(const Group& group, const json& moving) {
  const auto wrong = [&](const Error& why) {
    return damaged(group.chunk.at, "colliders that no scene has: " + why.text());
  };
  const json& document = *group.document;
  json home = document.is_object() ? document.value("colliders", json::array()) : json::array();
  if (!home.is_array()) return wrong({"/colliders", "no list", ""});
  for (json& each : home)
    if (each.is_object() && each.contains("mesh")) each["mesh"] = any_mesh;
  if (!moving.is_array()) return wrong({"moving", "no list", ""});
  for (const json& each : moving) {
    const json index = each.is_object() ? each.value("index", json()) : json();
    if (!index.is_number_unsigned() || index >= home.size() || !home[index.get<std::size_t>()].is_object())
      return wrong({"moving", "a collider that is not there", ""});
    for (const auto& [key, value] : each.items())
      if (key != "index") home[index.get<std::size_t>()][key] = value;
  }
  Result<std::vector<scene::Collider>> colliders = checked(std::move(home));
  if (!colliders) return wrong(colliders.error());
  for (std::size_t i = 0; i < colliders->size(); ++i)
    if (auto* body = std::get_if<scene::Body>(&(*colliders)[i].shape)) {
      const auto known = group.mesh->bodies.find(static_cast<std::uint32_t>(i));
      if (known == group.mesh->bodies.end()) return wrong({"body", "one without triangles", ""});
      body->mesh = known->second;
    }
  return colliders;
}

void BodyTracks::add(const std::vector<scene::Collider>& colliders) {
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    Track& track = track_of(i, colliders[i]);
    track.body.poses.resize(frames_);
    track.body.poses.push_back(pose(track, colliders[i].shape));
  }
  ++frames_;
}

std::vector<Body> BodyTracks::take() {
  std::vector<Body> bodies;
  for (Track& track : tracks_) {
    track.body.poses.resize(frames_);
    bodies.push_back(std::move(track.body));
  }
  return bodies;
}

BodyTracks::Track& BodyTracks::track_of(std::size_t collider, const scene::Collider& now) {
  const Form form = form_of(now.shape, half_length_);
  for (Track& track : tracks_)
    if (track.collider == collider && same(track.body.form, form)) return track;
  Track& made = tracks_.emplace_back();
  made.collider = collider;
  made.body.name = now.name;
  made.body.form = form;
  if (const auto* plane = std::get_if<scene::Plane>(&now.shape)) {
    const dvec3 to_middle = middle_ - plane->point;
    const dvec3 along = to_middle - glm::dot(to_middle, plane->normal) * plane->normal;
    made.aside = glm::inverse(least_turn(dvec3(0, 1, 0), plane->normal)) * along;
  }
  return made;
}

/// The turn of a shape of which only an axis is known, `home` at first: from one frame to the next it turns
/// no more than it must.
dquat BodyTracks::turned(const Track& track, const dvec3& axis, const dvec3& home) const {
  const auto last = std::find_if(track.body.poses.rbegin(), track.body.poses.rend(),
                                 [](const std::optional<Pose>& pose) { return pose.has_value(); });
  if (last == track.body.poses.rend()) return least_turn(home, axis);
  const dquat before = (*last)->turn;
  const dvec3 axis_before = before * home;
  if (glm::distance(axis_before, axis) < 1e-9) return before;
  return glm::normalize(least_turn(axis_before, axis) * before);
}

Pose BodyTracks::pose(Track& track, const scene::Shape& shape) const {
  Pose pose;
  if (const auto* body = std::get_if<scene::Body>(&shape)) {
    pose = {body->transform.translate, glm::quat_cast(scene::turn(body->transform.rotate)),
            dvec3(body->transform.scale)};
  } else {
    const scene::Solid solid = scene::solid(shape);
    pose.place = solid.point;
    if (const auto* sphere = std::get_if<scene::Sphere>(&shape)) pose.scale = dvec3(sphere->radius);
    if (const auto* box = std::get_if<scene::Box>(&shape)) {
      pose.scale = box->half;
      pose.turn = glm::quat_cast(box->axes);
    }
    if (std::holds_alternative<scene::Capsule>(shape))
      pose.turn = turned(track, solid.direction, dvec3(1, 0, 0));
    if (std::holds_alternative<scene::Plane>(shape)) {
      pose.turn = turned(track, solid.direction, dvec3(0, 1, 0));
      pose.place += pose.turn * track.aside;
    }
  }
  if (!track.body.poses.empty() && track.body.poses.back() &&
      glm::dot(track.body.poses.back()->turn, pose.turn) < 0.0)
    pose.turn = -pose.turn;
  return pose;
}

}  // namespace clothlab::film
