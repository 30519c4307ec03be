// Panels of a pattern: their outline is that of the mesh, its triangles are good, its runs are evenly spaced;
// what is wrong with a panel is told with its place.
#include "server/mesh/panel.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <set>

#include "server/mesh/planar_triangulation.h"
#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;
using glm::dvec2;
using scene::json;

namespace {

std::vector<dvec2> circle(double radius, int corners, const dvec2& middle = dvec2(0.0)) {
  std::vector<dvec2> ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / corners;
    ring.push_back(middle + radius * dvec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

/// The front of a shirt, with shoulders, armholes and a neck.
std::vector<dvec2> front() {
  return {{-.25, 0},  {.25, 0},   {.25, .4},  {.22, .45},  {.2, .5},    {.2, .55},
          {.22, .6},  {.1, .64},  {.07, .58}, {.0, .56},   {-.07, .58}, {-.1, .64},
          {-.22, .6}, {-.2, .55}, {-.2, .5},  {-.22, .45}, {-.25, .4}};
}

mesh::PanelMesh meshed(const mesh::Panel& panel) {
  mesh::PanelMesh made;
  const auto fault = mesh::mesh_panel(panel, made);
  if (fault) FAIL(fault->found);
  return made;
}

struct Quality {
  double least_angle = 90, area = 0, shortest = 1e300, longest = 0;
};

Quality quality(const mesh::PanelMesh& mesh) {
  Quality found;
  for (const auto& [a, b, c] : mesh.triangles) {
    const dvec2 corner[3] = {mesh.vertices[a], mesh.vertices[c], mesh.vertices[b]};
    found.area += 0.5 * mesh::doubled_area(corner[0], corner[1], corner[2]);
    found.least_angle = std::min(found.least_angle,
                                 glm::degrees(std::asin(mesh::least_sine(corner[0], corner[1], corner[2]))));
    for (int k = 0; k < 3; ++k) {
      const double length = glm::distance(corner[k], corner[(k + 1) % 3]);
      found.shortest = std::min(found.shortest, length);
      found.longest = std::max(found.longest, length);
    }
  }
  return found;
}

Result<scene::Document> document(const json& panel) {
  return scene::validate({{"version", 1}, {"cloths", {{{"mesh", {{"panel", panel}}}}}}});
}

const json square = {{0, 0}, {0.4, 0}, {0.4, 0.4}, {0, 0.4}};

Error refused(json change) {
  json panel = {{"outline", square}, {"edge", 0.1}};
  panel.merge_patch(change);
  const auto made = document(panel);
  INFO(panel.dump());
  REQUIRE_FALSE(made);
  return made.error();
}

}  // namespace

TEST_CASE(
    "a panel's triangles have no angle below 25 degrees, edges near the wanted length, and the outline's "
    "area") {
  for (const double edge : {0.015, 0.02, 0.025, 0.03, 0.04})
    for (const bool turned : {false, true}) {
      INFO("edge " << edge << (turned ? ", clockwise" : ""));
      std::vector<std::vector<dvec2>> outlines = {
          front(), circle(0.3, 48), {{0, 0}, {.5, 0}, {.5, .3}, {0, .3}}};
      for (std::vector<dvec2>& outline : outlines) {
        if (turned) std::reverse(outline.begin(), outline.end());
        const Quality found = quality(meshed({{outline}, {}, edge}));
        CHECK(found.least_angle > 25.0);
        CHECK(found.shortest > 0.5 * edge);
        CHECK(found.longest < 1.8 * edge);
      }
    }
  // Straight sides stay where they are; a rounded one is cut by chords: here of a square with a square hole.
  const mesh::PanelMesh frame =
      meshed({{{{0, 0}, {.4, 0}, {.4, .4}, {0, .4}}, {{.1, .1}, {.1, .3}, {.3, .3}, {.3, .1}}}, {}, 0.025});
  CHECK(quality(frame).area == Approx(0.12).epsilon(1e-12));
  CHECK(quality(frame).least_angle > 25.0);
  // All vertices are corners of triangles.
  std::set<std::uint32_t> used;
  for (const auto& corners : frame.triangles) used.insert(corners.begin(), corners.end());
  CHECK(used.size() == frame.vertices.size());
}

TEST_CASE(
    "runs of equal shape in two panels have equally many vertices, evenly spaced, in the outline's order") {
  std::vector<dvec2> other = front();
  other[9] = {0, 0.5};  // a deeper neck
  const std::vector<mesh::PanelRun> runs = {{0, 1}, {1, 2}, {2, 6}, {6, 7}, {16, 0}};
  const mesh::PanelMesh one = meshed({{front()}, runs, 0.02}), two = meshed({{other}, runs, 0.02});
  REQUIRE(one.runs.size() == runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    INFO("run " << i);
    REQUIRE(one.runs[i].size() == two.runs[i].size());
    CHECK(glm::distance(one.vertices[one.runs[i].front()], front()[runs[i].from]) < 1e-12);
    CHECK(glm::distance(one.vertices[one.runs[i].back()], front()[runs[i].to]) < 1e-12);
    for (std::size_t k = 0; k < one.runs[i].size(); ++k)
      CHECK(glm::distance(one.vertices[one.runs[i][k]], two.vertices[two.runs[i][k]]) < 1e-12);
  }
  const auto& hem = one.runs[0];
  CHECK(hem.size() == 26);
  for (std::size_t k = 1; k < hem.size(); ++k)
    CHECK(glm::distance(one.vertices[hem[k - 1]], one.vertices[hem[k]]) == Approx(0.02).epsilon(1e-9));
}

TEST_CASE(
    "a panel lies in the x-z plane, with its triangles counter-clockwise seen from +y, and pins count its "
    "vertices") {
  const auto made = document({{"outline", square}, {"edge", 0.1}, {"edges", {{"hem", {0, 1}}}}});
  REQUIRE(made);
  const auto& mesh = std::get<scene::TriangleMesh>(made->scene.cloths[0].mesh);
  for (const auto& [a, b, c] : mesh.triangles)
    CHECK(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]).y > 0.0);
  REQUIRE(mesh.runs.size() == 1);
  CHECK(mesh.runs[0].name == "hem");
  CHECK(mesh.runs[0].vertices == std::vector<std::uint32_t>{0, 1, 2, 3, 4});
  CHECK(made->value["cloths"][0]["mesh"]["panel"]["holes"] == json::array());
}

TEST_CASE("what is wrong with a panel is told with its place, and what is allowed") {
  const auto told = [](const Error& error, const std::string& where, const std::string& found) {
    CHECK(error.where == "/cloths/0/mesh/panel" + where);
    CHECK(error.what.find(found) != std::string::npos);
    CHECK_FALSE(error.remedy.empty());
  };
  told(refused({{"outline", {{0, 0}, {0.4, 0.4}, {0.4, 0}, {0, 0.4}}}}), "/outline/0",
       "meets that from corner 2");
  told(refused({{"outline", {{0, 0}, {0.4, 0}, {0.2, 0}, {0.2, 0.4}}}}), "/outline/0",
       "meets");  // back on itself
  told(refused({{"outline", {{0, 0}, {0.4, 0}, {0.4, 0}, {0, 0.4}}}}), "/outline/1",
       "the place of the next corner");
  told(refused({{"holes", {{{1, 1}, {1.1, 1}, {1.1, 1.1}}}}}), "/holes/0/0", "outside");
  told(refused({{"holes", {{{0.1, 0.1}, {0.5, 0.1}, {0.1, 0.2}}}}}), "/outline/1", "hole 0");
  told(refused({{"holes", {{{.1, .1}, {.3, .1}, {.3, .3}, {.1, .3}}, {{.15, .15}, {.2, .15}, {.2, .2}}}}}),
       "/holes/1/0", "a hole within hole 0");
  told(refused({{"edge", 0.001}}), "/edge", "vertices");
  told(refused({{"edges", {{"hem", {0, 4}}}}}), "/edges/hem/1", "4");
  told(refused({{"edges", {{"hem", {2, 2}}}}}), "/edges/hem", "[2,2]");
  told(refused({{"outline", {{0, 0}, {1, 0}}}}), "/outline", "");
}
