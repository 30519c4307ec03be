// `clothlab validate S...`: checks scene files and says what is in them, or the first thing that is wrong.
#include <iostream>
#include <memory>

#include "server/cli/commands.h"
#include "server/cli/fit_files.h"
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

/// Makes a scene of files, says what was chosen, and checks it as any other.
bool fit(const FitRequest& request) {
  const Result<std::vector<std::string>> chosen = fit_files(request);
  if (!chosen) {
    std::cerr << request.out << ": " << chosen.error().text() << "\n";
    return false;
  }
  for (const std::string& sentence : *chosen) note(sentence);
  return report(request.out, "");
}

}  // namespace

void add_validate(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("validate", "check scene files: what is wrong, where, and what is allowed");
  const auto names = std::make_shared<std::vector<std::string>>();
  const auto asset_root = std::make_shared<std::string>();
  const auto request = std::make_shared<FitRequest>();
  command->add_option("scene", *names, "scene files, or names of presets; with --fit the files of cloths")
      ->required();
  add_asset_root(*command, *asset_root);
  CLI::Option* out =
      command
          ->add_option("--fit", request->out,
                       "make a scene of meshes (.obj, .ply, .glb, .gltf) and write it there (.json)")
          ->type_name("F");
  command->add_option("--body", request->bodies, "with --fit: the file of a body; may be repeated")
      ->type_name("F")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->needs(out);
  command->add_option("--fabric", request->fabric, "with --fit: of the cloths (see `clothlab fabrics`)")
      ->type_name("NAME")
      ->capture_default_str()
      ->needs(out);
  command->footer(R"(Exit code 2 if any of them is not valid.
Examples:
  clothlab validate my-scene.json
  clothlab validate --fit dressed.json shirt.obj --body figure.glb

--fit guesses the unit from the size of all files together, takes a fabric's numbers, contact between surfaces if
there is a body or more than one cloth, a solver that holds, and pins at the top where nothing carries the cloth. It
says what it has chosen; all of it can be changed in the file. The meshes lie in the folder of the scene's file or
below.)");
  command->callback([names, asset_root, request, &exit_code] {
    if (!request->out.empty()) {
      request->cloths = *names;
      exit_code = fit(*request) ? exit_done : exit_usage;
      return;
    }
    bool all_valid = true;
    for (const std::string& name : *names) all_valid = report(name, *asset_root) && all_valid;
    exit_code = all_valid ? exit_done : exit_usage;
  });
}

}  // namespace clothlab::cli
