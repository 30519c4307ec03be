// Meshes that a scene names: files below a folder, uploads, and how pins count their vertices.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <numeric>
#include <set>

#include "server/model/model.h"
#include "server/scene/document.h"
#include "server/session/mesh_shelf.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
namespace fs = std::filesystem;
using scene::json;

namespace {

const std::string leaf = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n";

/// A folder of meshes, one beside it, and links.
struct Folder {
  fs::path outer = fs::temp_directory_path() / ("clothlab-assets-" + std::to_string(getpid()));
  fs::path root = outer / "root";
  Folder() {
    fs::remove_all(outer);
    fs::create_directories(root / "deep");
    write(root / "leaf.obj", leaf);
    write(root / "deep" / "LEAF.OBJ", leaf);
    write(root / "notes.txt", leaf);
    write(outer / "secret.obj", leaf);
    fs::create_symlink("leaf.obj", root / "inside.obj");
    fs::create_symlink("../secret.obj", root / "outside.obj");
    fs::create_symlink("..", root / "up");
    fs::create_directory(root / "folder.obj");
  }
  ~Folder() { fs::remove_all(outer); }
  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
};

json document_with(const json& mesh) {
  return {{"version", 1}, {"cloths", json::array({{{"mesh", mesh}}})}};
}

}  // namespace

TEST_CASE("a scene names meshes below a folder, and nothing else") {
  const Folder folder;
  const auto assets = std::make_shared<scene::FolderAssets>(folder.root);
  for (const char* name : {"leaf.obj", "deep/LEAF.OBJ", "inside.obj"}) {
    INFO(name);
    CHECK(scene::validate(document_with({{"obj", name}}), assets));
  }
  const std::vector<std::pair<std::string, const char*>> refused = {
      {"missing.obj", "no such file"},
      {"../secret.obj", "\"..\""},
      {"deep/../../secret.obj", "\"..\""},
      {(folder.outer / "secret.obj").string(), "an absolute path"},
      {"outside.obj", "a symbolic link that leads out"},
      {"up/secret.obj", "a symbolic link that leads out"},
      {"notes.txt", "does not end in .obj, .ply, .glb or .gltf"},
      {"folder.obj", "no ordinary file"},
      {"", "0 bytes of name"},
      {std::string("leaf\0.obj", 9), "a control character"},
      {std::string(300, 'a') + ".obj", "304 bytes of name"}};
  for (const auto& [name, what] : refused) {
    INFO(name);
    const auto document = scene::validate(document_with({{"obj", name}}), assets);
    REQUIRE_FALSE(document);
    CHECK(document.error().where == "/cloths/0/mesh/obj");
    CHECK(document.error().what.find(what) != std::string::npos);
    CHECK(document.error().remedy.find("--asset-root") != std::string::npos);
  }
}

TEST_CASE("what is wrong in a mesh's file is named by pointer, file, line, value and allowance") {
  const Folder folder;
  Folder::write(folder.root / "bad.obj", "v 0 0 0\nv 1 nan 0\n");
  const Error error =
      scene::validate(document_with({{"obj", "bad.obj"}}), std::make_shared<scene::FolderAssets>(folder.root))
          .error();
  CHECK(error.where == "/cloths/0/mesh/obj");
  CHECK(error.what == "bad.obj, line 2: \"nan\" as y");
  CHECK(error.remedy == "a number from -1e+06 to 1e+06");
}

TEST_CASE("pins and weights count the vertices of the file") {
  const Folder folder;
  const auto assets = std::make_shared<scene::FolderAssets>(folder.root);
  json value = document_with({{"obj", "leaf.obj"}});
  value["cloths"][0]["pins"] = json::array({{{"at", "vertex:3"}}});
  const auto document = scene::validate(value, assets);
  REQUIRE(document);
  const auto model = model::build(document->scene);
  REQUIRE(model);
  CHECK(model->vertex_count() == 3);
  CHECK(model->pin_motion[2] != model::not_pinned);  // (0, 1, 0)
  for (const char* at : {"vertex:0", "vertex:4"}) {
    value["cloths"][0]["pins"][0]["at"] = at;
    CHECK(scene::validate(value, assets).error().where == "/cloths/0/pins/0/at");
  }
}

TEST_CASE("a file is read again once it has changed, and not at all once its folder is closed") {
  const Folder folder;
  const auto assets = std::make_shared<scene::FolderAssets>(folder.root);
  REQUIRE(assets->mesh("leaf.obj", {}));
  CHECK(*assets->mesh("leaf.obj", {}) == *assets->mesh("leaf.obj", {}));
  Folder::write(folder.root / "leaf.obj", leaf + "v 5 5 5\nf 2 3 5\n");
  CHECK((*assets->mesh("leaf.obj", {}))->triangles.size() == 2);
  assets->close();
  fs::remove(folder.root / "leaf.obj");
  CHECK((*assets->mesh("leaf.obj", {}))->triangles.size() == 2);
  CHECK_FALSE(assets->mesh("inside.obj", {}));
}

TEST_CASE("a pattern gives the lengths at rest, and needs texture coordinates with an area") {
  const Folder folder;
  const auto assets = std::make_shared<scene::FolderAssets>(folder.root);
  const std::string sheet = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  Folder::write(folder.root / "twice.obj", sheet + "vt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\n" + faces);
  Folder::write(folder.root / "flat.obj", sheet + "vt 0 0\nvt 2 0\nvt 4 0\nvt 0 2\n" + faces);
  const auto document = scene::validate(document_with({{"obj", "twice.obj"}, {"pattern", "uv"}}), assets);
  REQUIRE(document);
  const auto model = model::build(document->scene);
  for (const auto& spring : model->springs()) {
    const double length =
        glm::distance(model->rest_position[spring.vertices[0]], model->rest_position[spring.vertices[1]]);
    CHECK(spring.law.rest_length == Approx(2 * length));
  }
  CHECK(model->springs().size() == 6);  // five edges, and one across the diagonal
  for (const char* name : {"flat.obj", "leaf.obj"})
    CHECK(scene::validate(document_with({{"obj", name}, {"pattern", "uv"}}), assets).error().where ==
          "/cloths/0/mesh/pattern");
  CHECK(scene::validate(document_with({{"grid", json::object()}, {"pattern", "uv"}}), assets).error().where ==
        "/cloths/0/mesh");
}

TEST_CASE(
    "a folded sheet of finite elements has its pattern's shape at rest, and without a pattern its own") {
  const Folder folder;
  const auto assets = std::make_shared<scene::FolderAssets>(folder.root);
  // Folded at right angles along the diagonal; the pattern of its second half lies elsewhere, and turned
  // over.
  Folder::write(folder.root / "folded.obj",
                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 0.5 0.70710678118654752\n"
                "vt 0 0\nvt 1 0\nvt 1 1\nvt 5 5\nvt 6 4\nvt 5 4\nf 1/1 2/2 3/3\nf 1/4 3/5 4/6\n");
  json value = document_with({{"obj", "folded.obj"}, {"pattern", "uv"}});
  value["cloths"][0]["material"] = {{"model", "fem"}, {"grain", 20}};
  value["cloths"][0]["mass"] = {{"area_density", 0.3}};
  value["cloths"][0]["transform"] = {{"scale", 2.0}};
  const auto document = scene::validate(value, assets);
  REQUIRE(document);
  const auto model = model::build(document->scene);
  REQUIRE(model);
  for (const auto& element : model->elements.of<elements::Membrane>()) {
    const auto at = [&](std::size_t corner) { return model->rest_position[element.vertices[corner]]; };
    const elements::Edges<elements::Membrane> place{{at(0) - at(1), at(0) - at(2)}};
    CHECK(elements::element_energy(element.law, place) < 1e-12);  // rounding; a tenth of strain costs 10 J
  }
  CHECK(std::accumulate(model->mass.begin(), model->mass.end(), 0.0) == Approx(0.3 * 4.0));
  value["cloths"][0]["mesh"].erase("pattern");
  const auto curved = scene::validate(value, assets);
  REQUIRE(curved);
  const auto own = model::build(curved->scene);
  REQUIRE(own);
  CHECK(model->elements.of<elements::Shell>().empty());
  CHECK(own->elements.of<elements::Shell>().size() == 2);
}

TEST_CASE("a session's uploads are bounded, come before files and are there again after a restart") {
  const Folder folder;
  const auto files = std::make_shared<scene::FolderAssets>(folder.root);
  session::MeshShelf shelf(files, folder.outer / "main");
  const std::string bigger = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const auto put = [&](const std::string& name, const std::set<std::string>& named) {
    const auto removed = shelf.make_place(name, bigger.size(), named);
    if (!removed) return std::string("refused");
    shelf.exchange(name, *shelf.read(name, bigger));
    CHECK(shelf.keep(name));
    return removed->empty() ? std::string() : removed->front();
  };
  CHECK(put("leaf.obj", {}).empty());
  CHECK((*shelf.mesh("leaf.obj", {}))->vertices.size() == 4);
  CHECK((*shelf.mesh("deep/LEAF.OBJ", {}))->vertices.size() == 3);
  std::set<std::string> all{"leaf.obj"};
  for (std::size_t i = 1; i < session::max_meshes; ++i) {
    const std::string name = "mesh " + std::to_string(i) + " / \xc3\xa9";
    all.insert(name);
    CHECK(put(name, {}).empty());
  }
  CHECK(put("one more", all) == "refused");
  CHECK(put("one more", {"leaf.obj"}) == "mesh 1 / \xc3\xa9");
  CHECK_FALSE(shelf.read("a", "v 0 0\n"));
  Folder::write(folder.outer / "main.mesh-0", "something else");

  session::MeshShelf again(files, folder.outer / "main");
  CHECK(again.restore().size() == 1);
  CHECK((*again.mesh("one more", {}))->triangles.size() == 2);
  CHECK((*again.mesh("leaf.obj", {}))->triangles.size() == 2);
  CHECK_FALSE(again.mesh("mesh 1 / \xc3\xa9", {}));
}
