#include "server/selftest/scenes.h"

#include <algorithm>
#include <system_error>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/model/hold.h"
#include "server/scene/document.h"
#include "server/sim/hands.h"

namespace clothlab::selftest {

namespace {

namespace fs = std::filesystem;
using scene::json;

Error unreadable(const std::string& file, const std::string& what) {
  return {"server/selftest/scenes/" + file, what, "install Clothlab again"};
}

/// The runs of one file. Throws where the file lacks what it must have.
Result<std::vector<ShortRun>> runs_of(const fs::path& path) {
  const std::string file = path.filename().string();
  const Result<std::string> text = read_file(path);
  if (!text) return text.error();
  const Result<json> value = scene::parse_json(*text, file, true);
  if (!value) return value.error();
  std::vector<ShortRun> runs;
  for (const json& described : value->at("runs")) {
    json document = value->at("scene");
    document["solver"] = described.at("solver");
    const Result<scene::Document> made = scene::validate(std::move(document));
    if (!made) return unreadable(file, made.error().text());
    ShortRun run;
    run.scene = made->scene;
    run.name = path.stem().string() + ", " + scene::name(run.scene.solver.method);
    run.steps = described.at("steps");
    run.quick = described.value("quick", false);
    run.has_reference = described.value("against", "reference") == "reference";
    if (value->contains("pull")) {
      const json& target = value->at("pull").at("target");
      run.pull = Pull{value->at("pull").at("vertex"), {target[0], target[1], target[2]}};
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

std::string ShortRun::places_file() const {
  const std::size_t comma = name.find(", ");
  return name.substr(0, comma) + "-" + name.substr(comma + 2) + ".json";
}

Result<std::vector<ShortRun>> short_runs() {
  const Result<fs::path> folder = data_path("server/selftest/scenes");
  if (!folder) return folder.error();
  std::vector<fs::path> files;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(*folder, failure))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<ShortRun> all;
  for (const fs::path& path : files) {
    try {
      Result<std::vector<ShortRun>> runs = runs_of(path);
      if (!runs) return runs.error();
      for (ShortRun& run : *runs) all.push_back(std::move(run));
    } catch (const json::exception& error) {
      return unreadable(path.filename().string(), error.what());
    }
  }
  if (all.empty()) return unreadable("", "no scenes");
  return all;
}

Result<std::unique_ptr<sim::Simulation>> started(const ShortRun& run) {
  Result<std::unique_ptr<sim::Simulation>> simulation = sim::Simulation::create(run.scene);
  if (!simulation || !run.pull) return simulation;
  const auto hold = std::make_shared<const model::Hold>(model::hold_on(
      (*simulation)->model(), run.scene, run.pull->vertex, (*simulation)->read_state().position));
  if (Status held = (*simulation)->set_hands({{hold, run.pull->target}}); !held) return held.error();
  return simulation;
}

}  // namespace clothlab::selftest
