#include "server/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <limits>

#include "tests/catch.h"

using namespace clothlab::render;

namespace {

/// Largest |x|, |y| of the box's corners in the picture, whose edge is at 1; 0 if a corner is behind the eye.
float reach(const Box& box, const glm::mat4& to_clip) {
  float largest = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::vec4 corner((i & 1 ? box.maximum : box.minimum).x, (i & 2 ? box.maximum : box.minimum).y,
                           (i & 4 ? box.maximum : box.minimum).z, 1);
    const glm::vec4 clip = to_clip * corner;
    if (clip.w <= 0 || std::abs(clip.z) > clip.w) return 0;
    largest = std::max({largest, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
  }
  return largest;
}

Box box_between(glm::vec3 a, glm::vec3 b) {
  Box box;
  box.add(a);
  box.add(b);
  return box;
}

}  // namespace

TEST_CASE("the whole box is in the picture and reaches well towards its edge, whatever shape either has") {
  for (const Box& box :
       {box_between({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), box_between({-5, 0, 0}, {5, 0.1f, 0.1f}),
        box_between({0, -3, 0}, {0.1f, 3, 0.1f}), box_between({1000, 0, 1000}, {1001, 1, 1001}),
        box_between({0, 0, 0}, {1e-3f, 1e-3f, 1e-3f})})
    for (const float aspect : {0.3f, 1.0f, 16.0f / 9.0f, 5.0f}) {
      const float reached = reach(box, frame(box, aspect).view_projection);
      CHECK(reached > 0.7f);
      CHECK(reached < 1.0f);
    }
}

TEST_CASE("the light's view holds the whole box") {
  const Box box = box_between({-2, -1, 0}, {2, 3, 1});
  const float reached = reach(box, light_view_projection(box, glm::vec3(0.0f, 0.8f, 0.6f)));
  CHECK(reached > 0.3f);
  CHECK(reached < 1.0f);
}

TEST_CASE(
    "vertices that are not finite are left out of the framing, and an empty scene still gives a picture") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  Box box;
  box.add(glm::vec3(nan, 0, 0));
  box.add(glm::vec3(0, infinity, 0));
  CHECK(box.empty());
  CHECK(std::isfinite(frame(box, 1.5f).eye.x));
  box.add(glm::vec3(1, 2, 3));
  CHECK(box.center() == glm::vec3(1, 2, 3));
  CHECK(reach(box, frame(box, 1.5f).view_projection) < 1.0f);
}
