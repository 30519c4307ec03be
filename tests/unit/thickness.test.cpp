// The thickness of self-collision that a mesh needs, and the warning if there is less.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "server/model/thickness.h"
#include "tests/catch.h"

using namespace clothlab;
using model::dvec3;

namespace {

/// The radius by trying points of the triangle: never more than the truth, and at most a share of 2 / n less.
double tried(const dvec3& a, const dvec3& b, const dvec3& c) {
  constexpr int n = 300;
  double farthest = 0.0;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      const dvec3 x = (double(i) * a + double(j) * b + double(n - i - j) * c) / double(n);
      farthest =
          std::max(farthest, std::min({glm::distance(x, a), glm::distance(x, b), glm::distance(x, c)}));
    }
  }
  return farthest;
}

model::Model grid(double width, int columns) {
  scene::Scene scene;
  scene.cloths.emplace_back().mesh = scene::Grid{columns, 11, width, 0.5};
  return *model::build(scene);
}

}  // namespace

TEST_CASE("a triangle's covering radius is the largest distance of its points from the nearest corner") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int n = 0; n < 40; ++n) {
    const dvec3 a(place(random), place(random), place(random)),
        b(place(random), place(random), place(random)), c(place(random), place(random), place(random));
    const double radius = model::covering_radius(a, b, c), found = tried(a, b, c);
    CHECK(found <= radius * (1.0 + 1e-12));
    CHECK(found > radius - 2.0 * (glm::distance(a, b) + glm::distance(b, c) + glm::distance(c, a)) / 300.0);
  }
  CHECK(model::covering_radius({0, 0, 0}, {1, 0, 0}, {0, 0, 1}) == Approx(std::sqrt(0.5)));
  CHECK(model::covering_radius({0, 0, 0}, {1, 0, 0}, {2, 0, 0}) == Approx(0.5));  // a line
  CHECK(model::covering_radius({1, 0, 0}, {1, 0, 0}, {1, 0, 0}) == 0.0);          // a point
}

TEST_CASE("the thickness that holds on a grid is 1.2 times half the diagonal of a cell") {
  CHECK(model::least_safe_thickness(grid(0.5, 11)) == Approx(1.2 * 0.5 * std::hypot(0.05, 0.05)));
  CHECK(model::least_safe_thickness(grid(1.0, 11)) == Approx(1.2 * 0.5 * std::hypot(0.1, 0.05)));
}

TEST_CASE(
    "a self-collision thinner than the mesh needs gets a warning with the number, a thicker one or none does "
    "not") {
  scene::Scene scene;
  scene.cloths.emplace_back().mesh = scene::Grid{11, 11, 0.5, 0.5};
  const model::Model model = *model::build(scene);
  CHECK(model::thickness_warning(model, scene).empty());
  scene.self_collision = scene::SelfCollision{0.0425, 0.2};
  CHECK(model::thickness_warning(model, scene).empty());
  scene.self_collision->thickness = 0.02;
  CHECK(model::thickness_warning(model, scene).find("0.0424 m") != std::string::npos);
}
