#include "server/cli/commands.h"

#include <charconv>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "server/model/dress.h"
#include "server/model/near_start.h"
#include "server/model/stability.h"
#include "server/model/sweep_stretch.h"
#include "server/model/thickness.h"
#include "server/sim/slipping.h"

namespace clothlab::cli {

int fail(const Error& error, ExitCode code) {
  std::cout.flush();
  std::cerr << "clothlab: error: " << error.text() << std::endl;
  return code;
}

void note(const std::string& text) {
  std::cout.flush();
  std::cerr << "clothlab: note: " << text << std::endl;
}

CLI::Validator whole_number(int least, int most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    int value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure == std::errc() && end == text.data() + text.size() && value >= least && value <= most)
      return {};
    return text + ", which is no whole number from " + std::to_string(least) + " to " + std::to_string(most);
  };
  return CLI::Validator(check, std::string());
}

void print_warnings(const model::Model& model, const scene::Scene& scene, double dt_limit,
                    const std::string& about) {
  std::vector<std::string> warnings{
      model::thickness_warning(model, scene), sim::slipping_warning(scene, model),
      model::near_start_warning(model, scene), model::step_warning(scene.solver, dt_limit),
      model::sweeps_warning(model, scene)};
  for (const std::string& note : scene::mesh_notes(scene)) warnings.push_back(note);
  if (const std::string led_out = model::dressed_note(model); !led_out.empty()) note(about + led_out);
  for (const std::string& warning : warnings) {
    if (warning.empty()) continue;
    std::cout.flush();
    std::cerr << "clothlab: warning: " << about << warning << std::endl;
  }
}

void SceneChoice::add_positional(CLI::App& command) {
  command.add_option("scene", name, "a preset's name (see `clothlab presets`) or a scene file")
      ->required()
      ->type_name("S");
  add_set(command);
}

void SceneChoice::add_option(CLI::App& command) {
  command.add_option("--scene,scene", name, "a preset's name (see `clothlab presets`) or a scene file")
      ->type_name("S")
      ->capture_default_str();
  add_set(command);
}

void SceneChoice::add_set(CLI::App& command) {
  // Each --set takes exactly one value, so that a positional S may follow.
  command
      .add_option("--set", set, "sets one value of the scene, e.g. --set /solver/dt=0.0005; may be repeated")
      ->type_name("POINTER=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_asset_root(command, asset_root);
}

void add_asset_root(CLI::App& command, std::string& folder) {
  command
      .add_option("--asset-root", folder,
                  "the folder of the meshes (.obj, .ply, .glb, .gltf) that a scene names; without it, the "
                  "folder that the "
                  "scene file is in")
      ->type_name("FOLDER");
}

Result<std::shared_ptr<scene::FolderAssets>> folder_of_meshes(const std::string& folder,
                                                              const std::string& scene) {
  std::error_code failure;
  if (!folder.empty() && !std::filesystem::is_directory(folder, failure))
    return Error{"--asset-root " + folder, "is not a folder", "give a folder that exists"};
  std::filesystem::path root = folder;
  if (root.empty() && !scene::is_preset(scene)) root = std::filesystem::path(scene).parent_path();
  return std::make_shared<scene::FolderAssets>(root.empty() ? "." : root);
}

Result<std::shared_ptr<scene::FolderAssets>> SceneChoice::assets() const {
  return folder_of_meshes(asset_root, name);
}

Result<scene::Document> SceneChoice::load() const {
  const auto meshes = assets();
  return meshes ? load(*meshes) : meshes.error();
}

Result<scene::Document> SceneChoice::load(std::shared_ptr<const scene::Assets> assets) const {
  Result<scene::Document> document = scene::load(name, std::move(assets));
  for (const std::string& assignment : set) {
    if (!document) break;
    document = scene::set_value(*document, assignment);
  }
  return document;
}

}  // namespace clothlab::cli
