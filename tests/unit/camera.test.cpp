#include "server/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

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

std::vector<Ball> corners_of(const Box& box) {
  std::vector<Ball> corners;
  for (int i = 0; i < 8 && !box.empty(); ++i)
    corners.push_back({{(i & 1 ? box.maximum : box.minimum).x, (i & 2 ? box.maximum : box.minimum).y,
                        (i & 4 ? box.maximum : box.minimum).z}});
  return corners;
}
Camera frame(const Box& box, float aspect, const View& view = {}) {
  return clothlab::render::frame(corners_of(box), box, view, aspect);
}

/// The edges of balls in the picture, whose edge is at 1: least and largest x and y, found along their
/// outlines.
struct Seen {
  glm::vec2 least{1e30f}, most{-1e30f};
  void add(const Ball& ball, const glm::mat4& to_clip) {
    constexpr int around = 64;
    for (int i = 0; i < around; ++i)
      for (int j = 0; j <= around / 2; ++j) {
        const float a = 2 * 3.14159265f * static_cast<float>(i) / around,
                    b = 2 * 3.14159265f * static_cast<float>(j) / around;
        const glm::vec3 out(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
        const glm::vec4 clip = to_clip * glm::vec4(ball.center + ball.radius * out, 1);
        least = glm::min(least, glm::vec2(clip) / clip.w);
        most = glm::max(most, glm::vec2(clip) / clip.w);
      }
  }
};

}  // namespace

TEST_CASE("balls touch the picture's margin on both sides of its tighter direction, wherever they are") {
  const std::vector<Ball> balls{{{0, 1, 0}, 0.5f}, {{2, 0.2f, -1}, 0.1f}, {{-1, 0, 3}, 0.0f}};
  Box box;
  for (const Ball& ball : balls) box.add(ball.center, ball.radius);
  for (const float aspect : {0.4f, 1.0f, 2.5f}) {
    Seen seen;
    for (const Ball& ball : balls) seen.add(ball, frame(balls, box, {}, aspect).view_projection);
    CHECK(seen.most.x == Approx(-seen.least.x).margin(0.01));  // of the outlines' 64 points
    CHECK(seen.most.y == Approx(-seen.least.y).margin(0.01));
    CHECK(std::max(seen.most.x, seen.most.y) == Approx(1 / 1.08).margin(0.01));  // the margin
  }
}

TEST_CASE("a camera that is said where to stand, to look, or how wide keeps to it, and chooses the rest") {
  const Box box = box_between({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f});
  View view;
  view.from = glm::vec3(0, 0.5f, 4);
  const Camera by_eye = frame(box, 1.5f, view);
  CHECK(by_eye.eye == *view.from);
  CHECK(reach(box, by_eye.view_projection) == Approx(1 / 1.08).margin(1e-3));
  view.to = glm::vec3(0.5f, 1, 0.5f);
  const glm::vec4 middle = frame(box, 1.5f, view).view_projection * glm::vec4(*view.to, 1);
  CHECK(std::abs(middle.x / middle.w) < 1e-5f);
  CHECK(std::abs(middle.y / middle.w) < 1e-5f);
  view.angle = 90;  // the eye sees as far up as the plane is away
  const glm::vec3 ahead = glm::normalize(*view.to - *view.from);
  const glm::vec3 above = glm::normalize(glm::vec3(0, 1, 0) - ahead.y * ahead);
  const glm::vec4 edge = frame(box, 1.5f, view).view_projection * glm::vec4(*view.from + ahead + above, 1);
  CHECK(edge.y / edge.w == Approx(1.0f).margin(1e-5));
  View aside;
  aside.to = glm::vec3(0.5f, 1, 0.5f);
  CHECK(reach(box, frame(box, 1.0f, aside).view_projection) == Approx(1 / 1.08).margin(1e-3));
}

TEST_CASE("from wherever a camera is told to stand, its subject is in the middle and fills the picture") {
  const std::vector<Ball> balls{{{0, 1, 0}, 0.5f}, {{2, 0.2f, -1}, 0.1f}, {{-1, 0, 3}, 0.0f}};
  for (const glm::vec3& from : {glm::vec3(9, 1, 2), glm::vec3(-3, 5, -6), glm::vec3(0.5f, 8, 0.9f),
                                glm::vec3(0.5f, 500, 0.9f), glm::vec3(2, -4, 5)}) {
    View view;
    view.from = from;
    Seen seen;
    for (const Ball& ball : balls) seen.add(ball, frame(balls, {}, view, 1.5f).view_projection);
    CHECK(seen.most.x == Approx(-seen.least.x).margin(0.01));  // of the outlines' 64 points
    CHECK(seen.most.y == Approx(-seen.least.y).margin(0.01));
    CHECK(std::max(seen.most.x, seen.most.y) == Approx(1 / 1.08).margin(0.01));  // the margin
  }
}

TEST_CASE("a camera inside its subject, or straight above it, still has a picture") {
  const Box box = box_between({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f});
  for (const glm::vec3& from : {glm::vec3(0, 0.5f, 0), glm::vec3(0.5f, 1, 0.5f), glm::vec3(0, 5, 0)}) {
    View view;
    view.from = from;
    const glm::mat4 to_clip = frame(box, 1.0f, view).view_projection;
    for (int i = 0; i < 16; ++i) CHECK(std::isfinite(to_clip[i / 4][i % 4]));
    if (from.y > 1) CHECK(reach(box, to_clip) == Approx(1 / 1.08).margin(1e-3));
  }
}

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
