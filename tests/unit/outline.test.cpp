#include "server/render/outline.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>

#include "server/scene/placement.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::dvec3;

namespace {

/// How far balls reach in a direction of unit length [m].
double reach(const std::vector<render::Ball>& balls, const dvec3& direction) {
  double farthest = -1e30;
  for (const render::Ball& ball : balls)
    farthest = std::max(farthest, glm::dot(dvec3(ball.center), direction) + ball.radius);
  return farthest;
}

std::vector<dvec3> directions() {
  std::vector<dvec3> all;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (x != 0 || y != 0 || z != 0) all.push_back(glm::normalize(dvec3(x, y, z)));
  return all;
}

constexpr double rounding = 1e-5;  // [m]: some of the last digits of a float of a few metres

}  // namespace

TEST_CASE("an outline reaches as far as its shape in every direction") {
  const scene::Sphere sphere{{1, 2, -1}, 0.4};
  const scene::Capsule capsule{{0, 1, 0}, {2, 0.5, -1}, 0.3};
  const scene::Box box{{-1, 0.5, 2}, {0.5, 0.1, 1.5}, scene::turn({20, 40, -70})};
  scene::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  const scene::Body body{std::make_shared<const scene::TriangleMesh>(mesh), {{1, 1, 0}, {10, 30, 50}, 0.5}};
  for (const dvec3& way : directions()) {
    CHECK(reach(render::outline(sphere), way) == Approx(glm::dot(sphere.center, way) + 0.4).margin(rounding));
    CHECK(reach(render::outline(capsule), way) ==
          Approx(std::max(glm::dot(capsule.a, way), glm::dot(capsule.b, way)) + capsule.radius)
              .margin(rounding));
    const dvec3 along = glm::abs(way * box.axes);  // the components along the box's axes
    CHECK(reach(render::outline(box), way) ==
          Approx(glm::dot(box.center, way) + glm::dot(along, box.half)).margin(rounding));
    double farthest = -1e30;
    for (const dvec3& vertex : mesh.vertices) {
      const dvec3 at = scene::turn({10, 30, 50}) * (0.5 * vertex) + dvec3(1, 1, 0);
      farthest = std::max(farthest, glm::dot(at, way));
    }
    CHECK(reach(render::outline(body), way) == Approx(farthest).margin(rounding));
  }
}

TEST_CASE("a plane has no outline") {
  CHECK(render::outline(scene::Plane{}).empty());
}
