// A coarser mesh that stands for the same cloth, and the other parts of a scene that can be left out.
#include "server/lab/measure/coarsen.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

#include "server/lab/measure/parts.h"
#include "server/reference/rest_shape.h"
#include "server/scene/fitted_springs.h"
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

namespace {

/// A knit that differs along warp and weft; with self-collision and wind, so that it has all parts.
scene::Document sheet(const std::string& more = "") {
  return test::document_of(R"({"version": 1, "cloths": [
      {"mesh": {"grid": {"columns": 9, "rows": 17, "width": 0.5, "height": 1}}, "mass": {"area_density": 0.2},
       "material": {"model": "fem", "warp": 60, "weft": 90, "poisson": 0.2, "shear": 20,
                    "bending": {"warp": 2e-5, "weft": 8e-5}, "damping": 0.001, "grain": 30, "strain_limit": null},
       "pins": [{"at": "edge:row:0"}]})" +
                           more +
                           R"(], "self_collision": {"thickness": 0.02}, "wind": {"velocity": [1, 0, 0]}})");
}
constexpr const char* spring_cloth =
    R"(, {"mesh": {"grid": {"columns": 5, "rows": 5, "width": 1, "height": 1}}, "mass": {"per_vertex": 0.01},
         "transform": {"translate": [2, 0, 0]}})";

const lab::Part& part_of(const std::vector<lab::Part>& parts, const std::string& name) {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const lab::Part& part) { return part.name == name; });
  INFO(name);
  REQUIRE(found != parts.end());
  return *found;
}

std::vector<std::string> names(const std::vector<lab::Part>& parts) {
  std::vector<std::string> result;
  for (const lab::Part& part : parts) result.push_back(part.name);
  return result;
}

}  // namespace

TEST_CASE("the parts of a scene are named after what its cloths are made of") {
  const std::vector<std::string> springs{
      "without bend springs", "without shear springs",    "without self-collision",          "without wind",
      "without damping",      "half the mesh resolution", "a quarter of the mesh resolution"};
  CHECK(names(lab::parts(*scene::load_preset("seed"))) == springs);
  const std::vector<std::string> sheets{"without bending",
                                        "with warp and weft alike",
                                        "with springs instead of finite elements",
                                        "without self-collision",
                                        "without wind",
                                        "without damping",
                                        "half the mesh resolution",
                                        "a quarter of the mesh resolution"};
  CHECK(names(lab::parts(sheet())) == sheets);
  CHECK(names(lab::parts(sheet(spring_cloth))).size() == 9);
}

TEST_CASE("springs instead of finite elements weigh the same and carry the same, and other cloths stay") {
  const scene::Document fem = sheet(spring_cloth);
  const auto parts = lab::parts(fem);
  const Result<scene::Document> made = part_of(parts, "with springs instead of finite elements").without(fem);
  INFO((made ? "" : made.error().text()));
  REQUIRE(made);
  CHECK(made->scene.cloths[1] == fem.scene.cloths[1]);
  scene::Cloth expected = fem.scene.cloths[0];
  expected.material = scene::springs_like(std::get<scene::Fem>(fem.scene.cloths[0].material), 0.0625, 0.2);
  CHECK(made->scene.cloths[0] == expected);
  // A mass by vertex is 9 x 17 of them over half a square metre.
  scene::json by_vertex = fem.value;
  by_vertex["cloths"][0]["mass"] = {{"per_vertex", 0.2 * 0.5 / (9 * 17)}};
  const auto same =
      part_of(parts, "with springs instead of finite elements").without(*scene::validate(by_vertex));
  REQUIRE(same);
  CHECK(same->scene.cloths[0].springs().bend == Approx(made->scene.cloths[0].springs().bend).epsilon(1e-12));
  // A triangle mesh is fitted as the square grid with as many vertices on the same area: 3 on half a square
  // metre.
  scene::json mesh = fem.value;
  mesh["cloths"][0]["mesh"] = {{"vertices", {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}}, {"triangles", {{0, 2, 1}}}};
  mesh["cloths"][0]["pins"] = scene::json::array();
  const auto fitted =
      part_of(parts, "with springs instead of finite elements").without(*scene::validate(mesh));
  REQUIRE(fitted);
  CHECK(fitted->scene.cloths[0].springs() ==
        scene::springs_like(std::get<scene::Fem>(fem.scene.cloths[0].material), std::sqrt(0.5 / 3.0), 0.2));
}

TEST_CASE("warp and weft alike have the mean moduli, the same coupling and the same resistance to slanting") {
  const scene::Document fem = sheet();
  const auto parts = lab::parts(fem);
  const Result<scene::Document> made = part_of(parts, "with warp and weft alike").without(fem);
  REQUIRE(made);
  const auto &before = std::get<scene::Fem>(fem.scene.cloths[0].material),
             &after = std::get<scene::Fem>(made->scene.cloths[0].material);
  CHECK(after.warp == Approx(std::sqrt(60.0 * 90.0)));
  CHECK(after.weft == after.warp);
  CHECK(after.bending.warp == Approx(4e-5));
  CHECK(after.bending.weft == after.bending.warp);
  CHECK(after.shear == before.shear);
  CHECK(after.grain == before.grain);
  // K01 = poisson weft / (1 - poisson^2 weft / warp)
  const auto coupling = [](const scene::Fem& of) {
    return of.poisson * of.weft / (1 - of.poisson * of.poisson * of.weft / of.warp);
  };
  CHECK(coupling(after) == Approx(coupling(before)).epsilon(1e-12));
  const auto again = part_of(parts, "with warp and weft alike").without(*made);
  REQUIRE_FALSE(again);
  CHECK(again.error().what == "the scene has no cloth of finite elements whose warp and weft differ");
}

TEST_CASE("a coarser sheet of finite elements keeps its material, and stretches as far when it is hung") {
  const scene::Document fine = hung(17, R"({"model": "fem", "warp": 30, "weft": 40, "poisson": 0.2,
      "shear": 15, "bending": 1e-4})");
  const scene::Document coarse = coarsened(fine, 2);
  CHECK(coarse.scene.cloths[0].material == fine.scene.cloths[0].material);
  // The stretch near the pinned row, where the sheet cannot narrow, is resolved to one cell: 1/8 of the
  // height.
  CHECK(stretch(coarse) == Approx(stretch(fine)).epsilon(0.05));
}

TEST_CASE("each part of a sheet is left out by a merge patch that makes the same scene, or is not there") {
  const scene::Document whole = sheet();
  for (const lab::Part& part : lab::parts(whole)) {
    INFO(part.name);
    const Result<scene::Document> without = part.without(whole);
    REQUIRE(without);
    CHECK_FALSE(*without == whole);
    const auto patched = scene::apply_patch(whole, lab::merge_patch(whole.value, without->value));
    REQUIRE(patched);
    CHECK(patched->scene == without->scene);
  }
  const scene::Document bare =
      hung(9, R"({"model": "fem", "warp": 30, "weft": 30, "bending": 0, "damping": 0})");
  std::vector<std::string> reasons;
  for (const lab::Part& part : lab::parts(bare))
    if (const auto without = part.without(bare); !without) reasons.push_back(without.error().what);
  CHECK(reasons ==
        std::vector<std::string>{"the scene has no bending stiffness",
                                 "the scene has no cloth of finite elements whose warp and weft differ",
                                 "the scene has no self-collision", "the scene has no wind",
                                 "the scene has no damping"});
}

TEST_CASE("each part is left out by a merge patch that makes the same scene, or is not there") {
  const scene::Document flag = *scene::load_preset("flag");
  for (const lab::Part& part : lab::parts(flag)) {
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
  for (const lab::Part& part : lab::parts(bare))
    if (const auto without = part.without(bare); !without) reasons.push_back(without.error().what);
  CHECK(reasons == std::vector<std::string>{"the scene has no bend springs", "the scene has no shear springs",
                                            "the scene has no self-collision", "the scene has no wind",
                                            "the scene has no damping"});
}
