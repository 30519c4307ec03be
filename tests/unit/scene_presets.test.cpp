// The scenes that come with the program, and scene files.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "server/model/stability.h"
#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::json;

TEST_CASE("every preset is valid, has its file's name and builds a model") {
  for (const std::string& name : scene::preset_names()) {
    INFO(name);
    const auto document = scene::load_preset(name);
    REQUIRE(document);
    CHECK(document->scene.name == name);
    CHECK(model::build(document->scene));
  }
  CHECK(scene::preset_names().front() == "seed");
}

TEST_CASE("the presets of the contract are there, and every preset file is one of them") {
  const std::vector<std::string> wanted = {
      "seed",          "flag",       "curtain",    "tablecloth", "drape",           "twist",
      "hanging-strip", "cantilever", "trampoline", "fabrics",    "skirt",           "poncho",
      "mannequin",     "knot",       "funnel",     "stack",      "tablecloth-pull", "blowup"};
  CHECK(scene::preset_names() == wanted);
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(CLOTHLAB_SOURCE_DIR "/server/scene/presets")) {
    if (file.path().extension() != ".json") continue;
    CHECK(std::find(wanted.begin(), wanted.end(), file.path().stem().string()) != wanted.end());
    ++files;
  }
  CHECK(files == wanted.size());
}

TEST_CASE("a preset's file says everything: no default is added to it") {
  for (const std::string& name : scene::preset_names()) {
    INFO(name);
    std::ifstream file(CLOTHLAB_SOURCE_DIR "/server/scene/presets/" + name + ".json");
    CHECK(json::parse(file) == scene::load_preset(name)->value);
  }
}

TEST_CASE("every preset but blowup steps well below its stability limit, and blowup beyond it") {
  for (const std::string& name : scene::preset_names()) {
    INFO(name);
    const scene::Scene scene = scene::load_preset(name)->scene;
    const double margin = scene.solver.dt / model::dt_limit(*model::build(scene), scene);
    INFO("dt / limit = " << margin);
    if (name == "blowup")
      CHECK(margin > 1.2);
    else
      CHECK(margin < 0.8);
  }
}

TEST_CASE("the seed is the contract's scene, floor and wind left out") {
  const scene::Scene seed = scene::load_preset("seed")->scene;
  CHECK(seed.cloths.size() == 1);
  CHECK(seed.colliders.size() == 1);
  CHECK(seed.cloths[0].springs() == scene::Springs{20000, 10000, 2000, 2});
  CHECK(seed.solver == scene::Solver{});
}

TEST_CASE("a scene file may have comments, and what is wrong with it is named with the file") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "clothlab_scene_file_test.json").string();
  std::ofstream(path) << "// mine\n{\"version\": 1, \"cloths\": [{\"mesh\": {\"grid\": {}}}]}";
  CHECK(scene::load(path));
  std::ofstream(path) << "{\"version\": 2}";
  CHECK(scene::load(path).error().where == path + ": /version");
  std::ofstream(path) << "{";
  CHECK(scene::load(path).error().where.rfind(path, 0) == 0);
  std::filesystem::remove(path);
  CHECK(scene::load(path).error().where == path);
  CHECK(scene::load(path).error().remedy.find("\"seed\"") != std::string::npos);
  CHECK(scene::load_preset("../seed").error().remedy.find("\"seed\"") != std::string::npos);
}
