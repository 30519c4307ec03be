// What people bring is mended with a note: what becomes of it, how it is told, and what is refused instead
// where a document wants no mending.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <map>

#include "server/mesh/mesh.h"
#include "server/scene/document.h"
#include "tests/catch.h"
#include "tests/mesh_area.h"

using namespace clothlab;
using scene::json;

namespace {

constexpr mesh::Limits limits{1 << 20, 1000, 2000};

mesh::Mesh mended(const std::string& text, const std::string& name = "a.obj") {
  Result<mesh::Mesh> mesh = mesh::read(text, name, limits);
  if (!mesh) FAIL(mesh.error().text());
  return *mesh;
}

/// The mesh, whose only note is this one; strictly read it is refused.
mesh::Mesh mended_with(const std::string& text, const std::string& note, const std::string& name = "a.obj") {
  const mesh::Mesh mesh = mended(text, name);
  INFO(text << "\n" << (mesh.notes.empty() ? "no note" : mesh.notes[0]));
  REQUIRE(mesh.notes.size() == 1);
  CHECK(mesh.notes[0] == note);
  CHECK_FALSE(mesh::read(text, name, limits, {.mend = false}));
  return mesh;
}

/// Edges of one triangle alone.
std::size_t border_edges(const mesh::Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const auto& corners : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++count[std::minmax({corners[i], corners[(i + 1) % 3]})];
  return static_cast<std::size_t>(
      std::count_if(count.begin(), count.end(), [](const auto& edge) { return edge.second == 1; }));
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Has one file.
struct File : scene::Assets {
  explicit File(std::string of) : text(std::move(of)) {}
  Result<scene::SharedMesh> mesh(const std::string& name, const mesh::Reading& reading) const override {
    Result<mesh::Mesh> mesh = mesh::read(text, name, limits, reading);
    if (!mesh) return mesh.error();
    return std::make_shared<const mesh::Mesh>(std::move(*mesh));
  }
  std::string text;
};

json cloth_of(const json& mesh) {
  return {{"version", 1}, {"cloths", json::array({{{"mesh", mesh}}})}};
}
json body_of(const json& mesh) {
  json value = cloth_of({{"grid", {{"columns", 2}, {"rows", 2}}}});
  value["cloths"][0]["transform"] = {{"translate", {0, 50, 0}}};
  value["colliders"] = json::array({{{"mesh", mesh}}});
  return value;
}
Result<scene::Document> validated(const json& value, const std::string& file) {
  return scene::validate(value, std::make_shared<File>(file));
}

}  // namespace

TEST_CASE("a face without area is left out, and the edge that it lay along is divided at its corner") {
  // The right square's left edge has a corner in its middle, which a face without area joins to the left one.
  const std::string faces = "v 1 0.5 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 6 7\nf 2 7 5\nf 5 7 3\n";
  const mesh::Mesh mesh = mended(square + faces + "f 2 5 3\n");
  CHECK(mesh.notes == std::vector<std::string>{
                          "1 face without area was left out: line 12",
                          "1 corner lies on an edge that has no vertex there: the edge was divided: line 8"});
  CHECK(mesh.triangles.size() == 6);
  CHECK(test::area_of(mesh) == Approx(2.0));
  CHECK(mesh.parts == 1);
  CHECK(border_edges(mesh) == 6);  // of the outline, which has six corners; before, 9
  CHECK(border_edges(*mesh::read(square + faces, "a.obj", limits, {.mend = false})) == 9);
  mended_with(square + "f 1 2 3 4\nf 1 2\n", "1 face without area was left out: line 6");
  mended_with(square + "f 1 2 3\nf 1 3 4\nf 1 1 2\nf 2 2 2\n",
              "2 faces without area were left out: line 7, line 8");
}

TEST_CASE("the texture of a divided edge is that of the whole one") {
  const mesh::Mesh mesh = mended(
      "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 0 0\nv 1 -1 0\nvt 0 0\nvt 8 0\nvt 0 8\nvt 5 5\nvt 6 5\nvt 5 6\n"
      "f 1/1 2/2 3/3\nf 1/4 5/5 4/6\n");
  REQUIRE(mesh.triangles.size() == 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t corner = 0; corner < 3 && i != 1; ++corner) {
      const glm::dvec3& place = mesh.vertices[mesh.triangles[i][corner]];
      CHECK(mesh.texture[i][corner] == glm::dvec2(2.0 * place.x, 2.0 * place.y));
    }
}

TEST_CASE("a face that has a corner twice has the others") {
  const mesh::Mesh mesh = mended_with(square + "f 1 2 2 3\nf 1 3 4\n",
                                      "1 face has a corner twice, of which one was left out: line 5");
  CHECK(test::area_of(mesh) == Approx(1.0));
}

TEST_CASE("a folded quad is cut so that a closed body stays closed") {
  const std::string body =  // a box whose top back edge is turned round: two quads cross themselves
      "v 0 0 0\nv 1 0 0\nv 0.4899 1 1\nv 0.5101 1 1\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\n"
      "f 5 4 3 6\nf 1 2 8 7\nf 1 5 6 2\nf 7 8 3 4\nf 1 7 4 5\nf 2 6 3 8\n";
  const mesh::Mesh mesh = mended_with(body,
                                      "2 polygons cross themselves or are folded flat, and were cut into "
                                      "triangles all the same: line 9, line 12");
  CHECK(mesh.triangles.size() == 12);
  CHECK(border_edges(mesh) == 0);
  // Its two halves cancel, so that it has no plane of its own.
  CHECK(mended(square + "f 1 3 2 4\n").triangles.size() == 2);
}

TEST_CASE("a triangle that is given twice is there once, either way round") {
  for (const char* again : {"f 3 1 4\n", "f 3 4 1\n"}) {
    const std::string text =
        std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n") + again;
    const mesh::Mesh mesh = mended_with(text, "1 triangle is there already and was left out: line 9");
    CHECK(mesh.triangles.size() == 4);
    CHECK(border_edges(mesh) == 0);
  }
}

TEST_CASE("words of other programs and a scanner's header are left out, and told with their lines") {
  mended_with("Cyberware 3030 head scan\n" + square +
                  "ny 0 0 0\nvv 1 2 3\ne 1 2\nf 1 2 3 4\nseam 1 2\nstitch 1 2 3 0.0\n",
              "6 lines with words that are none of this format were left out: \"Cyberware\" in line 1, "
              "\"ny\" in line 6, "
              "\"vv\" in line 7, \"e\" in line 8, \"seam\" in line 10, ...");
  const Result<mesh::Mesh> none = mesh::read("hello\nworld\n", "a.obj", limits);
  REQUIRE_FALSE(none);  // nothing is left of it
  CHECK(none.error().what.find("0 vertices and 0 faces") == 0);
  CHECK(none.error().what.find("\"hello\" in line 1") != std::string::npos);
}

TEST_CASE("vertices within a micrometre are one, unless the mesh is that fine or nothing is to be mended") {
  const auto halves = [](double apart, double size) {
    char line[400];
    std::snprintf(
        line, sizeof line,
        "v 0 0 0\nv %.17g 0 0\nv 0 %.17g 0\nv %.17g 0 0\nv %.17g %.17g 0\nv 0 %.17g 0\nf 1 2 3\nf 4 5 6\n",
        size, size, size + apart, size, size, size + apart);
    return std::string(line);
  };
  const mesh::Mesh mesh = mended(halves(0.99e-6, 1.0));
  CHECK(mesh.parts == 1);
  CHECK(mesh.notes ==
        std::vector<std::string>{
            "2 vertices within a micrometre of another one were joined with it: vertex 3, vertex 5"});
  CHECK(mended(halves(1.1e-6, 1.0)).parts == 2);
  CHECK(mended(halves(0.99e-6, 5e-4)).parts == 2);  // more than a thousandth of its sides
  CHECK(mesh::read(halves(0.99e-6, 1.0), "a.obj", limits, {.mend = false})->parts == 2);
}

TEST_CASE("vertices of no face are left out, which is told") {
  const mesh::Mesh mesh = mended("v 9 9 9\n" + square + "f 2 3 4 5\n");
  CHECK(mesh.notes == std::vector<std::string>{"1 vertex of no face was left out: vertex 0"});
  CHECK(mesh::read("v 9 9 9\n" + square + "f 2 3 4 5\n", "a.obj", limits, {.mend = false})->notes.empty());
}

TEST_CASE("strips of a .ply file are cut into their triangles, all with one side outside") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n10 0 1 2 3 -1 2 3 4 5 5\n";
  const mesh::Mesh mesh = mended_with(ply, "1 strip was cut into its triangles: line 16", "a.ply");
  CHECK(mesh.triangles.size() == 4);
  CHECK(mesh.flipped == 0);
  CHECK(test::area_of(mesh) == Approx(2.0));
}

TEST_CASE("what no cloth can be, a body is made of without what is wrong; of nothing it is refused") {
  const std::string moebius =
      "v 0 0 0\nv 3 0 1\nv 1 2 0\nv 0 1 3\nv 2 2 2\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n";
  for (const auto& [text, what] :
       {std::pair{square + "v 1 nan 0\nf 1 2 3\nf 1 3 4\nf 1 2 5\n", "line 5: \"nan\" as y"},
        {square + "f 1 2 3\nf 1 3 4\nf 1 2 9\n", "line 7: \"9\" as a vertex"},
        {square + "f 1 2 3 4\ncurv 0 1 1 2\n", "line 6: \"curv\", of a curved surface"},
        {moebius, "line 10: a surface with one side only"}}) {
    INFO(text);
    const auto body = validated(body_of({{"file", "a.obj"}}), text);
    if (!body) FAIL(body.error().text());
    CHECK(std::get<scene::Body>(body->scene.colliders[0].shape).mesh->triangles.size() ==
          (text == moebius ? 5 : 2));
    CHECK(scene::mesh_notes(body->scene).size() >= 1);
    for (const json& value : {cloth_of({{"file", "a.obj"}}), body_of({{"file", "a.obj"}, {"mend", false}})}) {
      const auto refused = validated(value, text);
      REQUIRE_FALSE(refused);
      CHECK(refused.error().what.find(std::string("a.obj, ") + what) == 0);
    }
  }
  for (const char* nothing :
       {"", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"})
    CHECK_FALSE(validated(body_of({{"file", "a.obj"}}), nothing));
}

TEST_CASE("a document reads a file by either name, mended unless it says no, with its notes") {
  const std::string twice = square + "f 1 2 3 4\nf 1 2 4\n";
  for (const char* key : {"file", "obj"}) {
    const auto document = validated(cloth_of({{key, "a.obj"}}), twice);
    REQUIRE(document);
    CHECK(document->value["cloths"][0]["mesh"]["mend"] == true);
    CHECK(scene::mesh_notes(document->scene) ==
          std::vector<std::string>{
              "/cloths/0/mesh: a.obj: 1 triangle is there already and was left out: line 6"});
    const auto strict = validated(cloth_of({{key, "a.obj"}, {"mend", false}}), twice);
    REQUIRE_FALSE(strict);
    CHECK(strict.error().where == std::string("/cloths/0/mesh/") + key);
  }
  for (const char* key : {"file", "obj"})
    CHECK(validated(cloth_of({{"grid", json::object()}, {key, "a.obj"}}), twice).error().where ==
          "/cloths/0/mesh");
  CHECK(validated(cloth_of({{"file", "a.obj"}, {"obj", "a.obj"}}), twice).error().where == "/cloths/0/mesh");
  CHECK(validated(cloth_of({{"file", "a.obj"}, {"mend", 1}}), twice).error().where == "/cloths/0/mesh/mend");
  for (const auto& [key, wrong] :
       {std::pair{"node", json("")}, {"node", json(1)}, {"pattern_scale", json(0)}})
    CHECK(validated(cloth_of({{"file", "a.obj"}, {key, wrong}}), twice).error().where ==
          std::string("/cloths/0/mesh/") + key);
  for (const char* key : {"node", "mend", "pattern_scale"})
    CHECK(validated(cloth_of({{"grid", json::object()}, {key, nullptr}}), twice).error().where ==
          "/cloths/0/mesh");
  // A body's own triangles, too.
  const json triangles = {{"vertices", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}},
                          {"triangles", {{0, 1, 2}, {0, 1, 3}}}};
  const auto body = validated(body_of(triangles), "");
  REQUIRE(body);
  CHECK(scene::mesh_notes(body->scene) ==
        std::vector<std::string>{"/colliders/0/mesh: 1 face without area was left out: triangle 1",
                                 "/colliders/0/mesh: 1 vertex of no face was left out: vertex 3"});
  json strict = triangles;
  strict["mend"] = false;
  CHECK_FALSE(validated(body_of(strict), ""));
}

TEST_CASE(
    "a mesh of another unit, far from the origin or with a pattern of another unit is told, with what to "
    "set") {
  const auto notes = [](double size, double from, double pattern, const json& more) {
    std::string text;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      char line[200];
      std::snprintf(line, sizeof line, "v %.17g %.17g 0\nvt %.17g %.17g\n", from + size * x, size * y,
                    pattern * x, pattern * y);
      text += line;
    }
    json value = cloth_of({{"file", "a.obj"}, {"pattern", "uv"}, {"pattern_scale", 1.0}});
    if (!more.is_null()) value["cloths"][0].merge_patch(more);
    const auto document = validated(value, text + "f 1/1 2/2 3/3 4/4\n");
    if (!document) FAIL(document.error().text());
    return scene::mesh_notes(document->scene);
  };
  const auto only = [&](const std::vector<std::string>& found, const std::string& part) {
    REQUIRE(found.size() == 1);
    INFO(found[0]);
    CHECK(found[0].find(part) != std::string::npos);
  };
  CHECK(notes(1.7, 0, 1.7, {}).empty());
  only(notes(1700, 0, 1700, {}), "\"scale\": 0.001} makes it 1.7 m");
  only(notes(170, 0, 170, {}), "\"scale\": 0.01} makes it 1.7 m");
  only(notes(0.0017, 0, 0.0017, {}), "\"scale\": 1000} makes it 1.7 m");
  CHECK(notes(1700, 0, 1700, {{"transform", {{"scale", 0.001}}}}).empty());
  only(notes(1.7, 5000, 1.7, {}), "0.596 mm apart");
  only(notes(1.7, 5000, 1.7, {}), "\"translate\": [-5000, -0.85, 0]");
  only(notes(1.0, 0, 0.01, {}), "\"pattern_scale\": 100 ");
  CHECK(notes(1.0, 0, 0.01, {{"mesh", {{"pattern_scale", 100}}}}).empty());
  // Vertices in centimetres and a pattern in metres: both are told.
  CHECK(notes(100.0, 0, 1.0, {}).size() == 2);
}
