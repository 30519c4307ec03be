// The law of contact between surfaces in double precision: pairs against a search over points, shares of
// steps against where the corners end.
#include <algorithm>
#include <cmath>
#include <random>

#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using elements::Corners;
using elements::Separation;
using glm::dvec3;

namespace {

Corners random_pair(std::mt19937& random, double flatness) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  Corners c;
  for (dvec3& x : c.x) x = {either(random), flatness * either(random), either(random)};
  return c;
}

/// The least distance of points of the two parts, over a grid of both.
double distance_by_search(bool edges, const Corners& c) {
  constexpr int steps = 60;
  double least = 1e30;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= (edges ? steps : steps - i); ++j) {
      const double s = double(i) / steps, t = double(j) / steps;
      const dvec3 d = edges ? c.x[0] + s * (c.x[1] - c.x[0]) - c.x[2] - t * (c.x[3] - c.x[2])
                            : c.x[0] - c.x[1] - s * (c.x[2] - c.x[1]) - t * (c.x[3] - c.x[1]);
      least = std::min(least, glm::length(d));
    }
  return least;
}

}  // namespace

TEST_CASE("a pair of surfaces is as far apart as its nearest points, which its weights give") {
  std::mt19937 random(7);
  for (int trial = 0; trial < 400; ++trial) {
    const bool edges = trial % 2 == 0;
    const Corners c = random_pair(random, trial % 4 < 2 ? 1.0 : 1e-3);
    const Separation apart = elements::separation(edges, c);
    const double searched = distance_by_search(edges, c);
    // The grid's points are at most a sixtieth of a side, 3.5 at most, from the nearest ones, on each part.
    CHECK(apart.gap <= searched + 1e-12);
    CHECK(apart.gap >= searched - 2.0 * 3.5 / 60.0);
    if (apart.gap == 0.0) continue;
    dvec3 between(0.0);
    for (int k = 0; k < 4; ++k) between += apart.weight[k] * c.x[k];
    CHECK(glm::length(between - apart.gap * apart.n) < 1e-9);
    CHECK(std::abs(glm::length(apart.n) - 1.0) < 1e-12);
  }
}

TEST_CASE("parallel edges and triangles without area have a distance, and a normal that divides them") {
  const Corners parallel{{{0, 0, 0}, {1, 0, 0}, {0.5, 0.1, 0}, {2, 0.1, 0}}};
  CHECK(elements::separation(true, parallel).gap == Approx(0.1));
  const Corners line{{{0.5, 0.2, 0}, {0, 0, 0}, {1, 0, 0}, {0.3, 0, 0}}};
  CHECK(elements::separation(false, line).gap == Approx(0.2));
  const Corners touching{{{0.5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0.3, 0, 0}}};
  CHECK(elements::separation(false, touching).gap == 0.0);
}

TEST_CASE(
    "with the shares of their steps that the law allows, the corners of a pair stay on their sides of its "
    "plane") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  constexpr double rounding = 1e-6;
  int cut = 0, near = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const bool edges = trial % 2 == 0;
    const Corners c = random_pair(random, 0.2);
    const Separation apart = elements::separation(edges, c);
    if (apart.gap < 1e-3) continue;
    dvec3 step[4];
    elements::StepsAlong along{};
    for (int k = 0; k < 4; ++k) {
      step[k] = dvec3(either(random), either(random), either(random));
      along.y[k] = glm::dot(apart.n, c.x[k]);
      along.d[k] = glm::dot(apart.n, step[k]);
    }
    const double plane = elements::dividing_plane(edges, along, rounding);
    for (int k = 0; k < 4; ++k) {
      const double side = k == 0 || (edges && k == 1) ? 1.0 : -1.0, room = side * (along.y[k] - plane);
      const double away = side * along.d[k], least = trial % 4 < 2 ? rounding : 0.02;
      const double share = elements::share_of_step(room, away, glm::length(step[k]), rounding, least);
      CHECK((share >= 0.0 && share <= 1.0));
      CHECK(room + share * away >= (room < least ? 0.9 * room : least) - 0.5 * rounding);
      near += room < least && share < 1.0;
      cut += share < 1.0;
    }
    if (elements::could_meet(edges, along, rounding)) continue;
    Corners after = c;
    for (int k = 0; k < 4; ++k) after.x[k] += step[k];
    CHECK(elements::gap_along(edges, after, apart.n) > 0.0);
  }
  CHECK(cut > 500);
  CHECK(near > 50);
}

TEST_CASE(
    "in single precision no corner gets over the plane, however near it is and whatever part of its share it "
    "takes") {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> either(-1.0, 1.0), logarithm(-7.5, -3.0);
  // 1 m from the origin a place is rounded by up to 6e-8 m in each coordinate: 1e-7 along any direction.
  constexpr double rounding = 2.5e-7;
  int over = 0, moved = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    const dvec3 n = glm::normalize(dvec3(either(random), either(random), either(random)));
    const glm::vec3 x(1.0 + 0.1 * either(random), 1.0 + 0.1 * either(random), 1.0 + 0.1 * either(random));
    const dvec3 wanted =
        std::pow(10.0, logarithm(random)) * dvec3(either(random), either(random), either(random));
    const glm::vec3 goal(dvec3(x) + wanted);
    const dvec3 step = dvec3(goal) - dvec3(x);
    const double room = 4.0 * rounding * std::abs(either(random)), size = glm::length(step);
    double share = elements::share_of_step(room, glm::dot(n, step), size, rounding, rounding);
    if (share < 1.0 || trial % 2 == 0) share *= std::abs(either(random));  // another pair may ask for less
    if (share < 1.0 && share * size < elements::shortest_part * rounding) share = 0.0;
    const glm::vec3 after = share < 1.0 ? x + static_cast<float>(share) * (goal - x) : goal;
    over += room + glm::dot(n, dvec3(after) - dvec3(x)) <= 0.0;
    moved += after != x;
  }
  CHECK(over == 0);
  CHECK(moved > 20000);
}

TEST_CASE(
    "a push takes the approach, holds what is slower than friction allows, and mends a share of an overlap") {
  dvec3 push, impulse;
  const dvec3 n(0, 1, 0);
  const auto contact = [&](double gap, const dvec3& moved, const dvec3& v) {
    elements::PairLoad load{};
    return elements::surface_contact(n, gap, moved, v, 0.01, 0.5, 0.0, 0.1, 1.0, true, true, load, push,
                                     impulse);
  };
  REQUIRE(contact(0.01, {0.001, -0.004, 0}, {1, -4, 0}));
  CHECK(glm::length(push - dvec3(-0.001, 0.004, 0)) < 1e-15);
  CHECK(glm::length(impulse - dvec3(-1, 4, 0)) < 1e-12);
  REQUIRE(contact(0.01, {0.004, -0.004, 0}, {4, -4, 0}));
  CHECK(glm::length(push - dvec3(-0.002, 0.004, 0)) < 1e-15);
  REQUIRE(contact(0.005, {}, {}));
  CHECK(glm::length(push - dvec3(0, 0.0005, 0)) < 1e-15);
  CHECK(impulse == dvec3(0.0));
  CHECK_FALSE(contact(0.02, {0, -0.009, 0}, {0, -9, 0}));
}

TEST_CASE("friction of all passes of a step together takes no more than the pushes of all passes allow") {
  dvec3 push, impulse;
  const dvec3 n(0, 1, 0);
  constexpr double friction = 0.5;
  elements::PairLoad load{};
  const auto pass = [&](const dvec3& moved, const dvec3& v, bool rubs) {
    return elements::surface_contact(n, 0.01, moved, v, 0.01, friction, 0.0, 0.1, 0.25, !rubs, true, load,
                                     push, impulse);
  };
  CHECK_FALSE(pass({0.1, 0, 0}, {9, 0, 0}, true));  // friction alone, and nothing has pushed yet
  dvec3 moved(0.1, -0.004, 0), v(9, -4, 0);
  double slid = 0.0, slowed = 0.0;
  for (int k = 0; k < 8; ++k) {
    const bool rubs = k >= 4;
    if (!pass(moved, v, rubs)) continue;
    if (rubs) CHECK((std::abs(push.y) < 1e-15 && std::abs(impulse.y) < 1e-12));
    moved += push;
    v += impulse;
    slid -= push.x;
    slowed -= impulse.x;
  }
  const double stopped = 1.0 - std::pow(0.75, 4);  // a quarter of what is left, four times
  CHECK(moved.y == Approx(-0.004 * (1.0 - stopped)));
  CHECK(slid == Approx(friction * 0.004 * stopped));
  CHECK(slowed == Approx(friction * 4.0 * stopped));
  // What is slower than that stops, in passes of friction, too.
  load.left = {friction * 0.004, friction * 4.0};
  moved = {0.001, 0, 0};
  for (int k = 0; k < 60; ++k)
    if (pass(moved, {}, true)) moved += push;
  CHECK(glm::length(moved) < 1e-9);
}
