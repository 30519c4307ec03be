// The law of solids in double precision: each kind against properties of its shape (tests/solids.h).
#include "tests/solids.h"

#include <cmath>
#include <random>

#include "server/scene/document.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec3;
using scene::Shape;
using test::a_shape_of_each_kind;
using test::turned_by;

namespace {

constexpr double margin = 0.03;

dvec3 random_vector(std::mt19937& random) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  return {either(random), either(random), either(random)};
}

elements::Solid with_margin(const Shape& shape) {
  const scene::Solid solid = scene::solid(shape);
  return {solid.point, solid.direction, solid.radius + margin, solid.second, solid.extent};
}

struct Outcome {
  bool near, met;
  dvec3 stopped, normal;
};
Outcome path(const Shape& before, const Shape& after, const dvec3& from, const dvec3& to) {
  const int kind = scene::solid(before).kind;
  const elements::Solid start = with_margin(before), end = with_margin(after);
  Outcome outcome;
  outcome.near = elements::solid_near(kind, start, end, from, to);
  outcome.met = elements::solid_contact(kind, start, end, from, to, outcome.stopped, outcome.normal);
  return outcome;
}

}  // namespace

TEST_CASE("there is a solid of each kind to try") {
  REQUIRE(a_shape_of_each_kind.size() == scene::solid_kinds);
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind) {
    CHECK(a_shape_of_each_kind[kind].index() == kind);
    CHECK(scene::solid(a_shape_of_each_kind[kind]).kind == static_cast<int>(kind));
  }
}

TEST_CASE("no path ends within the margin of a solid, of any kind, that moves and turns meanwhile") {
  std::mt19937 random(5);
  for (const Shape& home : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(home));
    int met = 0, passed = 0;
    for (int round = 0; round < 20000; ++round) {
      const Shape before = scene::moved_shape(home, glm::dmat3(1.0), dvec3(0.0));
      const Shape after =
          scene::moved_shape(home, turned_by(random_vector(random)), 0.5 * random_vector(random));
      const double reach = std::pow(10.0, static_cast<double>(random() % 5) - 2.0);
      const dvec3 from = 1.5 * random_vector(random), to = from + reach * random_vector(random);
      const Outcome outcome = path(before, after, from, to);
      ++(outcome.met ? met : passed);
      CHECK(test::depth(after, outcome.stopped) <= -margin + 1e-12);
      if (!outcome.met) {
        CHECK(outcome.stopped == to);
        continue;
      }
      CHECK(outcome.near);
      CHECK(glm::length(outcome.normal) == Approx(1.0));
      // The normal points outwards.
      CHECK(test::depth(after, outcome.stopped + 0.01 * outcome.normal) <
            test::depth(after, outcome.stopped));
    }
    CHECK(met > 500);
    CHECK(passed > 500);
  }
}

TEST_CASE(
    "a path that leads into a solid of any kind that stands still is stopped there, however long it is") {
  std::mt19937 random(6);
  for (const Shape& shape : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(shape));
    int entered = 0;
    for (int round = 0; round < 5000; ++round) {
      const dvec3 from = 1.5 * random_vector(random), to = from + 3.0 * random_vector(random);
      if (test::depth(shape, from) >= -margin || test::depth(shape, to) >= -margin) continue;
      bool enters = false;
      for (int share = 1; share < 100; ++share)
        enters = enters || test::depth(shape, glm::mix(from, to, 0.01 * share)) > 0.0;
      const Outcome outcome = path(shape, shape, from, to);
      if (enters) {
        ++entered;
        CHECK(outcome.met);
      }
    }
    // An endless shape has no far side, either.
    CHECK((entered > 100 || std::isinf(scene::bounds(shape).radius)));
  }
}

TEST_CASE("a vertex that rests within a solid, of any kind, leaves it by the shortest way") {
  std::mt19937 random(8);
  for (const Shape& shape : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(shape));
    int inside = 0;
    for (int round = 0; round < 5000; ++round) {
      const dvec3 x = random_vector(random);
      const double depth = test::depth(shape, x) + margin;
      const Outcome outcome = path(shape, shape, x, x);
      CHECK(outcome.met == (depth > 0.0));
      CHECK(elements::solid_depth(scene::solid(shape).kind, with_margin(shape), x) ==
            Approx(depth).margin(1e-12));
      if (!outcome.met) continue;
      ++inside;
      CHECK(glm::distance(outcome.stopped, x) == Approx(depth));
      CHECK(glm::distance(outcome.stopped, x + depth * outcome.normal) < 1e-14);
      CHECK(test::depth(shape, outcome.stopped) == Approx(-margin));
    }
    CHECK(inside > 200);
  }
}

namespace {

/// The share of a path where it is deepest in a shape: along a path the depth in a convex one rises, then
/// falls.
double deepest_share(const Shape& shape, const dvec3& from, const dvec3& to) {
  double low = 0.0, high = 1.0;
  const auto depth = [&](double share) { return test::depth(shape, glm::mix(from, to, share)); };
  for (int n = 0; n < 100; ++n) {
    const double first = (2.0 * low + high) / 3.0, second = (low + 2.0 * high) / 3.0;
    if (depth(first) < depth(second))
      low = first;
    else
      high = second;
  }
  return low;
}

/// Unit normal of the surface at the same depth.
dvec3 normal_at(const Shape& shape, const dvec3& x) {
  constexpr double step = 1e-6;
  dvec3 slope(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    dvec3 by(0.0);
    by[axis] = step;
    slope[axis] = test::depth(shape, x - by) - test::depth(shape, x + by);
  }
  return glm::normalize(slope);
}

}  // namespace

TEST_CASE(
    "a path meets a body exactly where it first comes within the margin, and goes on along its surface "
    "there") {
  std::mt19937 random(9);
  for (const Shape& shape : a_shape_of_each_kind) {
    if (std::isinf(scene::bounds(shape).radius)) continue;  // an endless shape needs no sweep
    INFO(scene::shape_to_json(shape));
    int entered = 0, rounded = 0;
    for (int round = 0; round < 20000; ++round) {
      const double reach = std::pow(10.0, static_cast<double>(random() % 4) - 2.0);
      const dvec3 from = random_vector(random), to = from + reach * random_vector(random);
      if (test::depth(shape, from) > -margin) continue;
      double high = deepest_share(shape, from, to), low = 0.0;
      const double room = test::depth(shape, glm::mix(from, to, high)) + margin;
      if (std::abs(room) < 1e-9) continue;  // grazes: rounding decides
      const Outcome outcome = path(shape, shape, from, to);
      CHECK(outcome.met == (room > 0.0));
      if (!outcome.met || room < 1e-4) continue;  // where it all but grazes, it enters at no sharp place
      for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (test::depth(shape, glm::mix(from, to, middle)) > -margin ? high : low) = middle;
      }
      ++entered;
      const dvec3 at = glm::mix(from, to, low), normal = normal_at(shape, at);
      CHECK(glm::distance(outcome.normal, normal) < 1e-5);  // of the differences, at a radius of 0.03 m
      CHECK(std::abs(glm::dot(outcome.stopped - at, outcome.normal)) < 1e-9);
      CHECK(glm::distance(outcome.stopped,
                          to + outcome.normal * glm::dot(outcome.stopped - to, outcome.normal)) < 1e-12);
      // On an edge or a corner of a box the normal is not that of a face.
      if (const auto* box = std::get_if<scene::Box>(&shape)) {
        const dvec3 along = glm::abs(glm::transpose(box->axes) * normal);
        rounded += std::max({along.x, along.y, along.z}) < 0.999;
      }
    }
    CHECK(entered > 500);
    if (std::holds_alternative<scene::Box>(shape)) CHECK(rounded > 100);
  }
}

TEST_CASE("a capsule whose ends are one point is a sphere, a box as good as none a sphere of the margin") {
  std::mt19937 random(10);
  const Shape sphere = scene::Sphere{{0.1, 0.0, -0.1}, 0.5},
              capsule = scene::Capsule{{0.1, 0.0, -0.1}, {0.1, 0.0, -0.1}, 0.5};
  const Shape point = scene::Sphere{{0.1, 0.0, -0.1}, 1e-9},
              box = scene::Box{{0.1, 0.0, -0.1}, dvec3(1e-9), glm::dmat3(1.0)};
  int met = 0;
  for (int round = 0; round < 5000; ++round) {
    const dvec3 from = random_vector(random), to = from + random_vector(random);
    for (const auto& [one, other] : {std::pair{sphere, capsule}, std::pair{point, box}}) {
      const Outcome wanted = path(one, one, from, to), found = path(other, other, from, to);
      CHECK(found.met == wanted.met);
      met += found.met;
      CHECK(glm::distance(found.stopped, wanted.stopped) <
            1e-6);  // the box's edge over the margin, a path long
      CHECK(glm::distance(found.normal, wanted.normal) < 1e-6);
    }
  }
  CHECK(met > 500);
}

TEST_CASE("a capsule that rolls, however fast, meets no vertex that stays beside it") {
  const Shape home = scene::Capsule{{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, 0.2};
  for (const double degrees : {1.0, 60.0, 179.0, 180.0}) {
    const Shape after = scene::moved_shape(home, turned_by({glm::radians(degrees), 0.0, 0.0}), dvec3(0.0));
    const elements::Solid before = with_margin(home);
    elements::Solid rolled = before;
    rolled.second = turned_by({glm::radians(degrees), 0.0, 0.0}) * before.second;
    const dvec3 x(0.1, 0.2 + 1.001 * margin, 0.0);
    dvec3 stopped, normal;
    CHECK(!elements::solid_contact(elements::solid_capsule, before, rolled, x, x, stopped, normal));
    CHECK(!path(home, after, x, x).met);
  }
}

TEST_CASE("no place and no path, however special, gives a solid of any kind a number that is none") {
  const auto finite = [](const dvec3& v) { return std::isfinite(v.x + v.y + v.z); };
  for (const Shape& home : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(home));
    const elements::Solid solid = with_margin(home);
    // At the middle, on axes, faces, edges and corners of the core, and as far outside.
    std::vector<dvec3> places;
    const glm::dmat3 axes =
        solid.second == dvec3(0.0)
            ? glm::dmat3(1.0)
            : glm::dmat3(solid.direction, solid.second, glm::cross(solid.direction, solid.second));
    for (int n = 0; n < 125; ++n) {
      const dvec3 steps = dvec3(n % 5, n / 5 % 5, n / 25) - 2.0;
      places.push_back(solid.point +
                       axes * (steps * (solid.extent == dvec3(0.0) ? dvec3(0.5) : solid.extent)));
    }
    for (const glm::dmat3& turn : {glm::dmat3(1.0), turned_by({glm::radians(180.0), 0.0, 0.0}),
                                   turned_by({0.0, 0.0, glm::radians(180.0)}), turned_by(dvec3(0.4))}) {
      const Shape after = scene::moved_shape(home, turn, dvec3(0.0));
      for (const dvec3& from : places)
        for (const dvec3& to : places) {
          const Outcome outcome = path(home, after, from, to);
          CHECK((finite(outcome.stopped) && finite(outcome.normal)));
          // The very middle of a sphere has no way out.
          if (home.index() != elements::solid_sphere)
            CHECK(test::depth(after, outcome.stopped) < -margin + 1e-12);
        }
    }
  }
}

TEST_CASE("a path that meets a solid at rest is no longer than what the cheapest test reaches") {
  std::mt19937 random(11);
  for (const Shape& home : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(home));
    int met = 0, out_of_reach = 0;
    for (int round = 0; round < 20000; ++round) {
      const double reach = std::pow(10.0, static_cast<double>(random() % 4) - 2.0);
      const dvec3 from = 1.5 * random_vector(random), to = from + reach * random_vector(random);
      const bool within =
          elements::solid_within(scene::solid(home).kind, with_margin(home), from, glm::distance(from, to));
      const bool meets = path(home, home, from, to).met;
      CHECK((within || !meets));
      met += meets;
      out_of_reach += !within;
    }
    CHECK(met > 100);
    CHECK(out_of_reach > 100);
  }
}

TEST_CASE("a path enters a solid at the share found, and its normal is where the depth falls fastest") {
  std::mt19937 random(10);
  for (const Shape& shape : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(shape));
    const int kind = scene::solid(shape).kind;
    const elements::Solid solid = with_margin(shape);
    int entered = 0;
    for (int round = 0; round < 5000; ++round) {
      const dvec3 from = 1.5 * random_vector(random), way = 1.5 * random_vector(random);
      dvec3 normal, n;
      const double depth = elements::nearest_of_solid(kind, solid, from, normal);
      CHECK(glm::length(normal) == Approx(1.0));
      constexpr double step = 1e-6;
      // Along the normal the distance from the core grows by as much, also in the core, whose nearest face it
      // leaves.
      CHECK(elements::nearest_of_solid(kind, solid, from + step * normal, n) ==
            Approx(depth - step).margin(1e-10));
      const double share = elements::solid_entry(kind, solid, solid, from, from + way, solid.radius);
      if (depth > 0.0) {
        CHECK(share == 0.0);
        continue;
      }
      const double end = std::min(share, 1.0);
      for (const double part : {0.2, 0.5, 0.8, 0.99})
        CHECK(elements::solid_depth(kind, solid, from + part * end * way) < 1e-9);
      if (share > 1.0) continue;
      ++entered;
      CHECK(elements::solid_depth(kind, solid, from + share * way) == Approx(0.0).margin(1e-9));
    }
    CHECK(entered > 100);
  }
}

TEST_CASE("an unknown kind of solid meets nothing") {
  const elements::Solid solid{dvec3(0.0), dvec3(0.0, 1.0, 0.0), 1.0, dvec3(1.0, 0.0, 0.0), dvec3(0.1)};
  for (const int kind : {-1, elements::solid_kinds}) {
    dvec3 stopped, normal;
    const dvec3 from(0.0, 3.0, 0.0), to(0.0, -0.5, 0.0);
    CHECK(!elements::solid_near(kind, solid, solid, from, to));
    CHECK(!elements::solid_within(kind, solid, from, 10.0));
    CHECK(elements::solid_depth(kind, solid, to) < 0.0);
    CHECK(!elements::solid_contact(kind, solid, solid, from, to, stopped, normal));
    CHECK(stopped == to);
  }
}

TEST_CASE("a shape that is placed has the numbers of the shape at home, placed") {
  std::mt19937 random(7);
  for (const Shape& home : a_shape_of_each_kind) {
    const glm::dmat3 rotation = turned_by(random_vector(random));
    const dvec3 translation = random_vector(random);
    const scene::Solid solid = scene::solid(home);
    const Shape there = scene::moved_shape(home, rotation, translation);
    CHECK(there.index() == home.index());
    // 1e-15: a rounding or two of numbers below 2, as a capsule's middle and axis are made of its ends.
    const auto near = [](const dvec3& a, const dvec3& b) { return glm::distance(a, b) < 1e-15; };
    CHECK(near(scene::solid(there).point, rotation * solid.point + translation));
    CHECK(near(scene::solid(there).direction, rotation * solid.direction));
    CHECK(scene::solid(there).radius == solid.radius);
    CHECK(near(scene::solid(there).extent, solid.extent));
    // A capsule looks the same however it rolls about its axis.
    if (home.index() != elements::solid_capsule)
      CHECK(near(scene::solid(there).second, rotation * solid.second));
  }
}

TEST_CASE("a shape that is written is read as the same shape") {
  for (const Shape& shape : a_shape_of_each_kind) {
    scene::json document = {{"version", 1}, {"cloths", {{{"mesh", {{"grid", scene::json::object()}}}}}}};
    document["colliders"] = scene::json::array({scene::shape_to_json(shape)});
    INFO(document);
    const Result<scene::Document> read = scene::validate(document);
    REQUIRE(read);
    const scene::Solid found = scene::solid(read->scene.colliders[0].shape), wanted = scene::solid(shape);
    CHECK(found.kind == wanted.kind);
    CHECK(found.point == wanted.point);
    // 1e-15: a rounding or two of sines and cosines, as a box is written by its angles.
    CHECK(glm::distance(found.direction, wanted.direction) < 1e-15);
    CHECK(glm::distance(found.second, wanted.second) < 1e-15);
    CHECK(found.radius == wanted.radius);
    CHECK(found.extent == wanted.extent);
  }
}
