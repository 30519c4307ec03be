#include "server/scene/solid.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/scene/placement.h"
#include "server/scene/sections.h"
#include "shaders/elements/elements.h"

namespace clothlab::scene {

namespace {

json list(const dvec3& v) {
  return {v.x, v.y, v.z};
}

template <int kind, class Of>
constexpr bool kind_matches = std::is_same_v<std::variant_alternative_t<kind, Shape>, Of>;

// The functions of each kind of shape, one kind after the other.

static_assert(kind_matches<elements::solid_sphere, Sphere>);
const char* name(const Sphere&) {
  return "sphere";
}
void read(const Reader& sphere, Sphere& into) {
  sphere.object({"center", "radius"});
  into = {sphere.member("center").vector(ranges::position), sphere.member("radius").number(ranges::length)};
}
json numbers(const Sphere& sphere) {
  return {{"center", list(sphere.center)}, {"radius", sphere.radius}};
}
Solid contact_numbers(const Sphere& sphere) {
  return {elements::solid_sphere, sphere.center, dvec3(0.0), sphere.radius};
}
Ball ball(const Sphere& sphere) {
  return {sphere.center, sphere.radius};
}
Sphere moved(const Sphere& home, const glm::dmat3& rotation, const dvec3& translation) {
  return {rotation * home.center + translation, home.radius};
}

static_assert(kind_matches<elements::solid_plane, Plane>);
const char* name(const Plane&) {
  return "plane";
}
void read(const Reader& plane, Plane& into) {
  plane.object({"point", "normal"});
  into = {plane.member("point").vector(ranges::position), plane.member("normal").direction()};
}
json numbers(const Plane& plane) {
  return {{"point", list(plane.point)}, {"normal", list(plane.normal)}};
}
Solid contact_numbers(const Plane& plane) {
  return {elements::solid_plane, plane.point, plane.normal, 0.0};
}
Ball ball(const Plane& plane) {
  return {plane.point, std::numeric_limits<double>::infinity()};
}
Plane moved(const Plane& home, const glm::dmat3& rotation, const dvec3& translation) {
  return {rotation * home.point + translation, rotation * home.normal};
}

static_assert(kind_matches<elements::solid_capsule, Capsule>);
const char* name(const Capsule&) {
  return "capsule";
}
void read(const Reader& capsule, Capsule& into) {
  capsule.object({"a", "b", "radius"});
  into = {capsule.member("a").vector(ranges::position), capsule.member("b").vector(ranges::position),
          capsule.member("radius").number(ranges::length)};
}
json numbers(const Capsule& capsule) {
  return {{"a", list(capsule.a)}, {"b", list(capsule.b)}, {"radius", capsule.radius}};
}
Solid contact_numbers(const Capsule& capsule) {
  const double length = glm::distance(capsule.a, capsule.b);
  const dvec3 axis = length > 0.0 ? (capsule.b - capsule.a) / length : dvec3(1.0, 0.0, 0.0);
  const dvec3 across = std::abs(axis.y) < 0.9 ? dvec3(0.0, 1.0, 0.0) : dvec3(1.0, 0.0, 0.0);
  return {elements::solid_capsule,
          0.5 * (capsule.a + capsule.b),
          axis,
          capsule.radius,
          glm::normalize(glm::cross(axis, across)),
          {0.5 * length, 0.0, 0.0}};
}
Ball ball(const Capsule& capsule) {
  return {0.5 * (capsule.a + capsule.b), 0.5 * glm::distance(capsule.a, capsule.b) + capsule.radius};
}
Capsule moved(const Capsule& home, const glm::dmat3& rotation, const dvec3& translation) {
  return {rotation * home.a + translation, rotation * home.b + translation, home.radius};
}

static_assert(kind_matches<elements::solid_box, Box>);
const char* name(const Box&) {
  return "box";
}
void read(const Reader& box, Box& into) {
  box.object({"center", "half", "rotate"});
  into = {box.member("center").vector(ranges::position), box.member("half").vector(ranges::length),
          turn(box.member("rotate", json::array({0.0, 0.0, 0.0})).vector(ranges::angle))};
}
json numbers(const Box& box) {
  return {{"center", list(box.center)}, {"half", list(box.half)}, {"rotate", list(angles(box.axes))}};
}
Solid contact_numbers(const Box& box) {
  return {elements::solid_box, box.center, box.axes[0], 0.0, box.axes[1], box.half};
}
Ball ball(const Box& box) {
  return {box.center, glm::length(box.half)};
}
Box moved(const Box& home, const glm::dmat3& rotation, const dvec3& translation) {
  return {rotation * home.center + translation, home.half, rotation * home.axes};
}

static_assert(std::is_same_v<std::variant_alternative_t<solid_kinds, Shape>, Body>);
const char* name(const Body&) {
  return "mesh";
}
json numbers(const Body& body) {
  const Transform& transform = body.transform;
  return {{"translate", list(transform.translate)},
          {"rotate", list(transform.rotate)},
          {"scale", transform.scale}};
}
Ball ball(const Body& body) {
  const std::vector<dvec3> points = placed(body.transform, body.mesh->vertices);
  if (points.empty()) return {body.transform.translate, 0.0};
  dvec3 low = points[0], high = points[0];
  for (const dvec3& point : points) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  Ball around{0.5 * (low + high), 0.0};
  for (const dvec3& point : points)
    around.radius = std::max(around.radius, glm::distance(point, around.center));
  return around;
}
Body moved(const Body& home, const glm::dmat3& rotation, const dvec3& translation) {
  return {home.mesh, moved(home.transform, rotation, translation)};
}

static_assert(elements::solid_kinds == solid_kinds, "each kind of solid has its law");

template <std::size_t... kind>
std::array<Shape, shape_kinds> default_shapes(std::index_sequence<kind...>) {
  return {Shape(std::in_place_index<kind>)...};
}
std::array<Shape, shape_kinds> default_shapes() {
  return default_shapes(std::make_index_sequence<shape_kinds>());
}

const char* name_of(const Shape& shape) {
  return std::visit([](const auto& of) { return name(of); }, shape);
}

}  // namespace

const std::array<const char*, shape_kinds>& shape_names() {
  static const auto names = [] {
    std::array<const char*, shape_kinds> all{};
    const std::array<Shape, shape_kinds> shapes = default_shapes();
    std::transform(shapes.begin(), shapes.end(), all.begin(), name_of);
    return all;
  }();
  return names;
}

Shape read_shape(const Reader& collider, const Assets* assets) {
  const std::string given = collider.exactly_one({shape_names().begin(), shape_names().end()});
  if (given == name(Body())) return read_body(collider, assets);
  if (collider.has("transform")) collider.fail("\"transform\" only beside \"mesh\"");
  for (Shape& shape : default_shapes()) {
    if (given != name_of(shape)) continue;
    std::visit(
        [&](auto& of) {
          if constexpr (!std::is_same_v<decltype(of), Body&>) read(collider.member(given), of);
        },
        shape);
    return shape;
  }
  return {};
}

Solid solid(const Shape& shape) {
  return std::visit(
      [](const auto& of) {
        if constexpr (std::is_same_v<decltype(of), const Body&>)
          return Solid{};
        else
          return contact_numbers(of);
      },
      shape);
}

Ball bounds(const Shape& shape) {
  return std::visit([](const auto& of) { return ball(of); }, shape);
}

Shape moved_shape(const Shape& home, const glm::dmat3& rotation, const dvec3& translation) {
  return std::visit([&](const auto& of) { return Shape(moved(of, rotation, translation)); }, home);
}

json shape_to_json(const Shape& shape) {
  json document = json::object();
  document[std::holds_alternative<Body>(shape) ? "transform" : name_of(shape)] =
      std::visit([](const auto& of) { return numbers(of); }, shape);
  return document;
}

}  // namespace clothlab::scene
