// `clothlab validate S...`: checks scene files and says what is in them, or the first thing that is wrong.
#include <iostream>
#include <memory>

#include "server/cli/commands.h"

namespace clothlab::cli {

namespace {

std::string counted(std::size_t count, const std::string& one, const std::string& more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

std::size_t vertices(const scene::Scene& scene) {
  std::size_t count = 0;
  for (const scene::Cloth& cloth : scene.cloths) {
    if (const auto* grid = std::get_if<scene::Grid>(&cloth.mesh))
      count += static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
    else
      count += std::get<scene::TriangleMesh>(cloth.mesh).vertices.size();
  }
  return count;
}

/// "seed.json: valid (...)" on stdout, or why not on stderr.
bool report(const std::string& name) {
  const Result<scene::Document> document = scene::load(name);
  if (!document) {
    std::cerr << document.error().text() << "\n";
    return false;
  }
  const scene::Scene& scene = document->scene;
  std::cout << name << ": valid (" << counted(scene.cloths.size(), "cloth", "cloths") << ", "
            << counted(vertices(scene), "vertex", "vertices") << ", "
            << counted(scene.colliders.size(), "collider", "colliders") << ", dt " << scene.solver.dt
            << " s)\n";
  return true;
}

}  // namespace

void add_validate(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("validate", "check scene files: what is wrong, where, and what is allowed");
  const auto names = std::make_shared<std::vector<std::string>>();
  command->add_option("scene", *names, "scene files, or names of presets")->required();
  command->footer("Exit code 2 if any of them is not valid.");
  command->callback([names, &exit_code] {
    bool all_valid = true;
    for (const std::string& name : *names) all_valid = report(name) && all_valid;
    exit_code = all_valid ? exit_done : exit_usage;
  });
}

}  // namespace clothlab::cli
