// Crossings: exact in degenerate positions, and found by the tree of boxes as by comparing all pairs.
#include "server/model/crossings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "server/model/orientation.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec3;
using model::meets;
using model::Surfaces;

namespace {

const dvec3 a(0, 0, 0), b(1, 0, 0), c(0, 0, 1);

/// Asks in every order of the corners and of the segment's ends; all answers must be the same.
bool meets_in_any_order(const dvec3& p, const dvec3& q, const std::array<dvec3, 3>& corner) {
  const bool answer = meets(p, q, corner[0], corner[1], corner[2]);
  for (const auto& [i, j, k] : {std::array{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
    const auto at = [&](int n) { return corner[static_cast<std::size_t>(n)]; };
    CHECK(meets(p, q, at(i), at(j), at(k)) == answer);
    CHECK(meets(q, p, at(i), at(j), at(k)) == answer);
  }
  return answer;
}

bool meets_abc(const dvec3& p, const dvec3& q) {
  return meets_in_any_order(p, q, {a, b, c});
}

/// Triangles of `vertices` places in a cube, drawn to a raster of 1 / steps: a coarse one has many
/// coincidences.
struct Soup {
  Surfaces surfaces;
  std::vector<dvec3> x;
};
Soup soup(std::uint32_t seed, std::uint32_t vertices, std::uint32_t triangles, int steps) {
  std::mt19937 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  Soup made;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    dvec3 place;
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = below(static_cast<std::uint32_t>(steps)) / static_cast<double>(steps);
    made.x.push_back(place);
  }
  model::Model model;
  for (std::uint32_t i = 0; i < triangles; ++i)
    model.triangles.push_back({below(vertices), below(vertices), below(vertices)});
  made.surfaces = model::surfaces_of(model);
  made.surfaces.first_body_vertex = vertices / 2;
  return made;
}

/// The crossings of all pairs, one after another.
std::vector<model::Crossing> of_all_pairs(const Soup& soup) {
  std::vector<model::Crossing> found;
  const auto& x = soup.x;
  for (const auto& [i, j] : soup.surfaces.edges)
    for (const auto& triangle : soup.surfaces.triangles) {
      const auto& [k, l, m] = triangle;
      if (std::count(triangle.begin(), triangle.end(), i) + std::count(triangle.begin(), triangle.end(), j))
        continue;
      if (i >= soup.surfaces.first_body_vertex && k >= soup.surfaces.first_body_vertex) continue;
      if (meets(x[i], x[j], x[k], x[l], x[m])) found.push_back({{i, j}, triangle, {}});
    }
  return found;
}

/// A sheet of side x side vertices in the x-z plane, `turned` about the x axis, as one mesh.
void add_sheet(model::Model& model, std::vector<dvec3>& x, std::uint32_t side, double height, double turned) {
  const auto first = static_cast<std::uint32_t>(x.size());
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const double along = static_cast<double>(i / side) / side - 0.5;
    x.emplace_back(static_cast<double>(i % side) / side, height + along * std::sin(turned),
                   along * std::cos(turned));
  }
  for (std::uint32_t r = 0; r + 1 < side; ++r)
    for (std::uint32_t k = 0; k + 1 < side; ++k) {
      const std::uint32_t v = first + r * side + k;
      model.triangles.push_back({v, v + side, v + side + 1});
      model.triangles.push_back({v, v + side + 1, v + 1});
    }
  model.rest_position.resize(x.size());
}

}  // namespace

TEST_CASE(
    "an edge crosses a triangle if it passes through its inside, and not if it ends before or passes by") {
  CHECK(meets_abc({0.2, -1, 0.2}, {0.2, 1, 0.2}));
  CHECK_FALSE(meets_abc({0.2, 0.1, 0.2}, {0.2, 1, 0.2}));
  CHECK_FALSE(meets_abc({0.7, -1, 0.7}, {0.7, 1, 0.7}));
  CHECK_FALSE(meets_abc({0.2, 0.1, 0.2}, {0.8, 0.1, 0.8}));  // beside it in a plane of its own
}

TEST_CASE(
    "what touches exactly counts as a crossing: an end on a face, a side or a corner, sides that meet") {
  CHECK(meets_abc({0.25, 0, 0.25}, {0.25, 1, 0.25}));
  CHECK(meets_abc({0.5, 0, 0.5}, {0.5, 1, 0.5}));
  CHECK(meets_abc({1, 0, 0}, {1, 1, 0}));
  CHECK(meets_abc({0.5, -1, 0.5}, {0.5, 1, 0.5}));
  CHECK(meets_abc({-1, -1, 0}, {1, 1, 0}));  // through the corner a
  const double above = std::nextafter(0.0, 1.0);
  CHECK_FALSE(meets_abc({0.25, 1e-300, 0.25}, {0.25, 1, 0.25}));
  CHECK_FALSE(meets_abc({1.0 + 0x1p-52, -1, above}, {1.0 + 0x1p-52, 1, 0}));
}

TEST_CASE("a segment in the plane of a triangle crosses it where they overlap or touch, not beside it") {
  CHECK(meets_abc({-1, 0, 0.25}, {2, 0, 0.25}));           // across
  CHECK(meets_abc({0.1, 0, 0.1}, {0.2, 0, 0.2}));          // inside
  CHECK(meets_abc({0.2, 0, 0}, {0.7, 0, 0}));              // on a side
  CHECK(meets_abc({1, 0, 0}, {2, 0, 0}));                  // from a corner
  CHECK_FALSE(meets_abc({0, 0, 2}, {2, 0, 0}));            // beside it
  CHECK_FALSE(meets_abc({1 + 0x1p-50, 0, 0}, {2, 0, 0}));  // in line with a side, beyond it
}

TEST_CASE("triangles without area and edges without length cross where they have a point in common") {
  const std::array<dvec3, 3> line{a, {0.5, 0, 0}, b}, point{a, a, a};
  CHECK(meets_in_any_order({0.7, -1, 0}, {0.7, 1, 0}, line));
  CHECK(meets_in_any_order({0.7, 0, 0}, {3, 0, 0}, line));
  CHECK_FALSE(meets_in_any_order({0.7, -1, 0.1}, {0.7, 1, 0.1}, line));  // passes at a distance
  CHECK_FALSE(meets_in_any_order({1.5, 0, 0}, {3, 0, 0}, line));
  CHECK(meets_in_any_order({-1, -1, -1}, {1, 1, 1}, point));
  CHECK_FALSE(meets_in_any_order({-1, -1, -1}, {1, 1, 1.5}, point));
  CHECK(meets_abc({0.1, 0, 0.1}, {0.1, 0, 0.1}));
  CHECK_FALSE(meets_abc({0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}));
  CHECK(meets_in_any_order({0, 0, 0}, {0, 0, 0}, point));
}

TEST_CASE("the side of a plane, and of a line, is exact where floating point has its sign wrong") {
  // Whole numbers of up to 2^31: a point of the plane is exact, and products of 2^90 are rounded by 2^37,
  // more than a step off the plane makes of them.
  std::mt19937 random(5);
  const auto vector = [&] {
    const auto number = [&] { return static_cast<double>(random() >> 2) - 0x1p29; };
    const double x = number(), y = number();
    return dvec3(x, y, number());
  };
  for (int i = 0; i < 200; ++i) {
    const dvec3 p = vector(), u = vector(), v = vector();
    const double along = static_cast<double>(random() % 5) - 2.0, across = static_cast<double>(random() % 5);
    const dvec3 on = p + along * u + across * v, q = p + u, r = p + v;
    const double normal = u.x * v.y - u.y * v.x;
    CHECK(model::side(p, q, r, on) == 0);
    CHECK(model::side(p, q, r, on + dvec3(0, 0, 1)) == (normal > 0.0 ? 1 : -1));
    CHECK(model::side(p, q, r, on - dvec3(0, 0, 1)) == (normal > 0.0 ? -1 : 1));
    CHECK(model::turn(p, q, p + along * u, {0, 1}) == 0);
    CHECK(model::turn(p, q, p + along * u + dvec3(0, 1, 0), {0, 1}) == (u.x > 0.0 ? 1 : -1));
  }
  // Coordinates that differ in size so much that differences are rounded, too.
  const double far = 0x1p60;
  CHECK(model::side({1, 0, 0}, {far, 0, 0}, {1, 1, 0}, {0.3, 0.3, 0x1p-60}) == 1);
  CHECK(model::side({1, 0, 0}, {far, 0, 0}, {1, 1, 0}, {0.3, 0.3, 0}) == 0);
  CHECK(model::turn({1, 1, 0}, {far, far, 0}, {3, 3, 0}, {0, 1}) == 0);
  CHECK(model::turn({1, 1, 0}, {far, far, 0}, {3, 3 + 0x1p-50, 0}, {0, 1}) == 1);
}

TEST_CASE(
    "the tree of boxes finds the crossings that comparing all pairs finds, in soups with and without "
    "coincidences") {
  std::uint64_t crossings = 0;
  for (const int steps : {3, 8, 1 << 20})
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      INFO("raster " << steps << ", seed " << seed);
      const Soup made = soup(seed, 60, 80, steps);
      const std::vector<model::Crossing> pairs = of_all_pairs(made);
      const model::Crossings found = model::find_crossings(made.surfaces, made.x, {100000});
      REQUIRE(found.count == pairs.size());
      REQUIRE(found.first.size() == pairs.size());
      CHECK(found.complete);
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        CHECK(found.first[i].edge == pairs[i].edge);
        CHECK(found.first[i].triangle == pairs[i].triangle);
      }
      crossings += found.count;
    }
  CHECK(crossings > 10000);  // or the soups are too thin to tell
}

TEST_CASE("a crossing's place lies on the edge, in the triangle's plane") {
  const Soup made = soup(7, 60, 80, 1 << 20);
  const model::Crossings found = model::find_crossings(made.surfaces, made.x, {50});
  REQUIRE(found.first.size() == 50);
  for (const model::Crossing& each : found.first) {
    const auto x = [&](std::uint32_t i) { return made.x[i]; };
    const dvec3 p = x(each.edge[0]), q = x(each.edge[1]), corner = x(each.triangle[0]);
    const dvec3 normal = glm::cross(x(each.triangle[1]) - corner, x(each.triangle[2]) - corner);
    // Coordinates are of size 1, so errors are a few 2^-53, here over a normal's length of down to 1e-3.
    CHECK(std::abs(glm::dot(normal, each.place - corner)) < 1e-14);
    CHECK(glm::length(glm::cross(q - p, each.place - p)) < 1e-14);
  }
}

TEST_CASE("a search stops at the number of crossings it is to count, and names no more than it is to name") {
  const Soup made = soup(3, 60, 80, 1 << 20);
  const model::Crossings all = model::find_crossings(made.surfaces, made.x);
  const model::Crossings some = model::find_crossings(made.surfaces, made.x, {2, 10});
  CHECK(all.complete);
  CHECK(all.first.size() == 5);
  CHECK(some.count == 10);
  CHECK_FALSE(some.complete);
  CHECK(some.first == std::vector(all.first.begin(), all.first.begin() + 2));
}

TEST_CASE(
    "a flat sheet, in whatever direction, crosses itself nowhere; two that intersect do so along a line") {
  for (const double turned : {0.0, 0.3, 1.0}) {
    INFO(turned);
    model::Model model;
    std::vector<dvec3> x;
    add_sheet(model, x, 64, 0.3, turned);
    CHECK(model::find_crossings(model::surfaces_of(model), x).count == 0);
    add_sheet(model, x, 64, 0.3 + 1e-4, turned + 0.5);
    const std::uint64_t across = model::find_crossings(model::surfaces_of(model), x).count;
    // Each sheet has 63 cells along the line, in each of which it meets about two triangles' sides of the
    // other one.
    CHECK(across > 63 * 2);
    CHECK(across < 63 * 12);
  }
}

TEST_CASE("bodies cross cloths, not each other") {
  model::Model model;
  std::vector<dvec3> x;
  add_sheet(model, x, 8, 0.0, 0.0);
  const auto first = static_cast<std::uint32_t>(x.size());
  // Two triangles that cross each other and the sheet.
  for (const dvec3& place : {dvec3(0.31, -1, -0.2),
                             {0.32, 1, -0.2},
                             {0.33, 0.5, 0.3},
                             {0.32, -1, 0.2},
                             {0.35, 1, 0.2},
                             {0.31, 0.5, -0.4}})
    x.push_back(place);
  model.body_triangles = {{first, first + 1, first + 2}, {first + 3, first + 4, first + 5}};
  model.bodies = {{.triangle_count = 2, .motion = {}}};
  Surfaces surfaces = model::surfaces_of(model);
  const model::Crossings found = model::find_crossings(surfaces, x, {1000});
  CHECK(found.count > 4);
  for (const model::Crossing& each : found.first) CHECK((each.edge[0] < first) != (each.triangle[0] < first));
  CHECK(model::find_crossings(model::surfaces_of(model, model::Bodies::none), x).count == 0);

  // Of two sheets that cross, one is a body: cloths can be left out among themselves.
  model::Model both;
  std::vector<dvec3> y;
  add_sheet(both, y, 8, 0.0, 0.0);
  add_sheet(both, y, 8, 1e-4, 0.5);
  Surfaces of_cloths = model::surfaces_of(both);
  CHECK(model::find_crossings(of_cloths, y).count > 0);
  of_cloths.among_cloths = false;
  CHECK(model::find_crossings(of_cloths, y).count == 0);
  of_cloths.first_body_vertex = 64;
  CHECK(model::find_crossings(of_cloths, y).count > 0);
}
