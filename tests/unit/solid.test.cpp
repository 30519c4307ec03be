// The law of solids in double precision: each kind against properties of its shape (tests/solids.h).
#include "tests/solids.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "server/scene/document.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec3;
using scene::Shape;
using test::a_shape_of_each_kind;

namespace {

constexpr double margin = 0.03;

dvec3 random_vector(std::mt19937& random) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  return {either(random), either(random), either(random)};
}

glm::dmat3 turned_by(const dvec3& turn) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::length(turn), glm::normalize(turn)));
}

elements::Solid with_margin(const Shape& shape) {
  const scene::Solid solid = scene::solid(shape);
  return {solid.point, solid.direction, solid.radius + margin};
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

TEST_CASE("there is a shape of each kind to try") {
  REQUIRE(a_shape_of_each_kind.size() == scene::shape_kinds);
  for (std::size_t kind = 0; kind < scene::shape_kinds; ++kind) {
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

TEST_CASE("an unknown kind of solid meets nothing") {
  const elements::Solid solid{dvec3(0.0), dvec3(0.0, 1.0, 0.0), 1.0};
  for (const int kind : {-1, elements::solid_kinds}) {
    dvec3 stopped, normal;
    const dvec3 from(0.0, 3.0, 0.0), to(0.0, -0.5, 0.0);
    CHECK(!elements::solid_near(kind, solid, solid, from, to));
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
    CHECK(scene::solid(there).point == rotation * solid.point + translation);
    CHECK(scene::solid(there).direction == rotation * solid.direction);
    CHECK(scene::solid(there).radius == solid.radius);
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
    CHECK(glm::distance(found.direction, wanted.direction) < 1e-15);
    CHECK(found.radius == wanted.radius);
  }
}
