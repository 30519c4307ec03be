// `clothlab validate S...`: checks scene files and says what is in them, or the first thing that is wrong.
#include <iostream>
#include <memory>

#include "server/cli/commands.h"
#include "server/model/model.h"
#include "server/model/stability.h"

namespace clothlab::cli {

namespace {

std::string counted(std::size_t count, const std::string& one, const std::string& more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

/// Prints "seed.json: valid (...)" on stdout, or the error on stderr. Warnings about a valid scene go to
/// stderr, too. Returns true if the scene is valid.
bool report(const std::string& name, const std::string& asset_root) {
  const auto assets = folder_of_meshes(asset_root, name);
  const Result<scene::Document> document = assets ? scene::load(name, *assets) : assets.error();
  if (!document) {
    std::cerr << document.error().text() << "\n";
    return false;
  }
  const Result<model::Model> model =
      model::build(document->scene);  // finds e.g. a pin whose box selects no vertex
  if (!model) {
    std::cerr << name << ": " << model.error().text() << "\n";
    return false;
  }
  const std::size_t springs = model->springs().size(),
                    triangles = model->elements.of<elements::Membrane>().size();
  std::cout << name << ": valid (" << counted(model->cloths.size(), "cloth", "cloths") << ", "
            << counted(model->vertex_count(), "vertex", "vertices") << ", "
            << (springs > 0 || triangles == 0 ? counted(springs, "spring", "springs") + ", " : "")
            << (triangles > 0 ? counted(triangles, "finite element", "finite elements") + ", " : "")
            << counted(document->scene.colliders.size(), "collider", "colliders") << ")\n";
  // The lab chooses the step of the method `auto`, not the user.
  const double limit =
      document->scene.solver.automatic ? model::no_limit : model::dt_limit_if_near(*model, document->scene);
  print_warnings(*model, document->scene, limit, name + ": ");
  if (const Status served = scene::check_bytes(document->value); !served)
    std::cerr << "clothlab: warning: " << name << ": `clothlab serve` refuses it: " << served.error().text()
              << std::endl;
  return true;
}

}  // namespace

void add_validate(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("validate", "check scene files: what is wrong, where, and what is allowed");
  const auto names = std::make_shared<std::vector<std::string>>();
  const auto asset_root = std::make_shared<std::string>();
  command->add_option("scene", *names, "scene files, or names of presets")->required();
  add_asset_root(*command, *asset_root);
  command->footer("Exit code 2 if any of them is not valid.");
  command->callback([names, asset_root, &exit_code] {
    bool all_valid = true;
    for (const std::string& name : *names) all_valid = report(name, *asset_root) && all_valid;
    exit_code = all_valid ? exit_done : exit_usage;
  });
}

}  // namespace clothlab::cli
