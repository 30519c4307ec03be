// A coarser mesh that stands for the same cloth, and the other parts of a scene that can be left out.
#include "server/lab/measure/coarsen.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

#include "server/lab/measure/parts.h"
#include "server/reference/rest_shape.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

scene::Document document(const std::string& cloth) {
  return test::document_of(R"({"version": 1, "gravity": [0, 0, 0.5], "cloths": [)" + cloth + "]}");
}

/// A cloth of a square metre, 1 kg, hung by its first row in its plane.
scene::Document hung(int count, const std::string& material, const std::string& more = "") {
  const std::string n = std::to_string(count);
  return document(R"({"mesh": {"grid": {"columns": )" + n + R"(, "rows": )" + n +
                  R"(, "width": 1, "height": 1}}, "mass": {"per_vertex": )" +
                  scene::json(1.0 / (count * count)).dump() + R"(}, "material": )" + material +
                  R"(, "pins": [{"at": "edge:row:0"}])" + more + "}");
}

scene::Document coarsened(const scene::Document& fine, int factor) {
  Result<scene::Document> coarse = lab::coarsen(fine, factor);
  INFO((coarse ? "" : coarse.error().text()));
  REQUIRE(coarse);
  return *coarse;
}

Error not_coarsened(const scene::Document& fine) {
  const Result<scene::Document> coarse = lab::coarsen(fine, 2);
  REQUIRE_FALSE(coarse);
  return coarse.error();
}

double total_mass(const model::Model& model) {
  return std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
}

/// Distance of the last row below its place at rest, on average [m].
double stretch(const scene::Document& document) {
  const reference::World world = *reference::make_world(document.scene, 0.0);
  const auto shape = reference::rest_shape(world);
  INFO((shape ? "" : shape.error().text()));
  REQUIRE(shape);
  const int columns = std::get<scene::Grid>(document.scene.cloths[0].mesh).columns;
  double sum = 0.0;
  for (int i = 1; i <= columns; ++i)
    sum += (shape->position.end() - i)->z - (world.model.rest_position.end() - i)->z;
  return sum / columns;
}

}  // namespace

TEST_CASE(
    "a coarser mesh has half or a quarter of the cells along each side, rounded, and never less than one") {
  CHECK(lab::coarser_count(25, 2) == 13);
  CHECK(lab::coarser_count(25, 4) == 7);
  CHECK(lab::coarser_count(24, 2) == 13);
  CHECK(lab::coarser_count(24, 4) == 7);
  CHECK(lab::coarser_count(3, 4) == 2);
  CHECK(lab::coarser_count(2, 2) == 2);
}

TEST_CASE("a coarser cloth keeps its mass, its extents and its pins") {
  for (const char* preset : {"seed", "flag", "curtain", "trampoline", "hanging-strip", "tablecloth"}) {
    const scene::Document fine = *scene::load_preset(preset);
    const Result<scene::Document> made = lab::coarsen(fine, 2);
    INFO(preset << (made ? "" : ": " + made.error().text()));
    REQUIRE(made);
    const model::Model before = *model::build(fine.scene), after = *model::build(made->scene);
    CHECK(after.vertex_count() < 0.4 * before.vertex_count());
    // Mass by area leaves out no triangle, mass by vertex is shared out anew: both exactly.
    CHECK(total_mass(after) == Approx(total_mass(before)).epsilon(1e-12));
    for (std::size_t i = 0; i < before.cloths.size(); ++i) {
      const model::ClothRange &a = before.cloths[i], &b = after.cloths[i];
      CHECK(glm::distance(before.rest_position[a.first_vertex], after.rest_position[b.first_vertex]) < 1e-12);
      CHECK(glm::distance(before.rest_position[a.first_vertex + a.vertex_count - 1],
                          after.rest_position[b.first_vertex + b.vertex_count - 1]) < 1e-12);
    }
    const auto pinned = [](const model::Model& model) {
      return std::count_if(model.pin_motion.begin(), model.pin_motion.end(),
                           [](std::int32_t pin) { return pin != model::not_pinned; });
    };
    CHECK(after.motions == before.motions);
    CHECK((pinned(after) > 0) == (pinned(before) > 0));
    for (std::uint32_t i = 0; i < after.vertex_count(); ++i)
      if (after.pin_motion[i] != model::not_pinned) {
        const auto same =
            std::find_if(before.rest_position.begin(), before.rest_position.end(),
                         [&](const auto& x) { return glm::distance(x, after.rest_position[i]) < 1e-12; });
        REQUIRE(same != before.rest_position.end());
        CHECK(before.pin_motion[static_cast<std::size_t>(same - before.rest_position.begin())] ==
              after.pin_motion[i]);
      }
  }
}

TEST_CASE("a hung sheet of structural springs stretches as far on a coarser mesh, exactly") {
  // g M (m - 1) / (2 n k) on n x m vertices: springs are scaled to keep it.
  const scene::Document fine = hung(17, R"({"structural": 20, "shear": 0, "bend": 0})");
  const double expected = 0.5 * 1.0 * 16 / (2 * 17 * 20.0);
  CHECK(stretch(fine) == Approx(expected).epsilon(1e-6));
  for (const int factor : {2, 4}) CHECK(stretch(coarsened(fine, factor)) == Approx(expected).epsilon(1e-6));
}

TEST_CASE(
    "with shear and bend springs a hung sheet stretches as far at half the resolution within 5 percent") {
  // The stretch near the pinned row and the edges is resolved to one cell, 1/8 of the cloth's height at half
  // the resolution; shear and bend springs bear 2/5 of the load.
  const scene::Document fine = hung(17, R"({"structural": 20, "shear": 10, "bend": 3})");
  CHECK(stretch(coarsened(fine, 2)) == Approx(stretch(fine)).epsilon(0.05));
}

TEST_CASE("a weight sewn into a hem stays as heavy, and pins and weights need a vertex to be at") {
  const std::string soft = R"({"structural": 20, "shear": 10, "bend": 0})";
  const scene::Document hem =
      hung(9, soft, R"(, "weights": [{"at": "edge:row:8", "mass": 0.1}, {"at": "corner:4,4", "mass": 0.3},
      {"at": {"box": [[-1, -1, 0.7], [1, 1, 0.8]]}, "mass": 0.2}])");
  const scene::Document coarse = coarsened(hem, 2);
  CHECK(total_mass(*model::build(coarse.scene)) ==
        Approx(total_mass(*model::build(hem.scene))).epsilon(1e-12));
  CHECK(coarse.value["cloths"][0]["weights"][0]["at"] == "edge:row:4");
  CHECK(coarse.value["cloths"][0]["weights"][1]["at"] == "corner:2,2");
  const Error between = not_coarsened(hung(9, soft, R"(, "weights": [{"at": "vertex:1", "mass": 0.1}])"));
  CHECK(between.where == "/cloths/0/weights/0/at");
  CHECK(between.what.find("between the vertices of the coarser mesh of 5 x 5") != std::string::npos);
  // A box that holds vertices of the fine mesh only.
  CHECK(not_coarsened(
            hung(9, soft, R"(, "weights": [{"at": {"box": [[-1, -1, 0.1], [1, 1, 0.15]]}, "mass": 0.1}])"))
            .where == "/cloths/0/weights/0/at");
  CHECK(not_coarsened(hung(9, soft, R"(, "start": {"scatter": {"size": 1, "seed": 1}})")).where ==
        "/cloths/0/start");
  CHECK(
      not_coarsened(document(R"({"mesh": {"vertices": [[0,0,0],[1,0,0],[0,0,1]], "triangles": [[0,2,1]]}})"))
          .what == "triangle meshes are not made coarser");
}

TEST_CASE(
    "between the vertices of a coarser mesh positions are bilinear, and the mesh itself gives its own") {
  const scene::Document fine = hung(8, R"({"structural": 20})"), coarse = coarsened(fine, 2);
  const model::Model from = *model::build(fine.scene), to = *model::build(coarse.scene);
  const auto bent = [](const glm::dvec3& x) { return glm::dvec3(2 * x.x, 3 * x.x * x.z, x.z - 1); };
  std::vector<glm::vec3> position;
  for (const glm::dvec3& x : to.rest_position) position.emplace_back(bent(x));
  const auto found = lab::at_fine_vertices(fine.scene, coarse.scene, position);
  REQUIRE(found.size() == from.vertex_count());
  for (std::size_t i = 0; i < found.size(); ++i)
    CHECK(glm::distance(found[i], bent(from.rest_position[i])) < 1e-6);
}

TEST_CASE("each part is left out by a merge patch that makes the same scene, or is not there") {
  const scene::Document flag = *scene::load_preset("flag");
  for (const lab::Part& part : lab::parts()) {
    INFO(part.name);
    const Result<scene::Document> without = part.without(flag);
    REQUIRE(without);
    CHECK_FALSE(*without == flag);
    const auto patched = scene::apply_patch(flag, lab::merge_patch(flag.value, without->value));
    REQUIRE(patched);
    CHECK(patched->scene == without->scene);
  }
  const scene::Document bare = hung(9, R"({"structural": 20, "shear": 0, "bend": 0, "damping": 0})");
  std::vector<std::string> reasons;
  for (const lab::Part& part : lab::parts())
    if (const auto without = part.without(bare); !without) reasons.push_back(without.error().what);
  CHECK(reasons == std::vector<std::string>{"the scene has no bend springs", "the scene has no shear springs",
                                            "the scene has no self-collision", "the scene has no wind",
                                            "the scene has no damping"});
}
