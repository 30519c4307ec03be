// The subcommands of `clothlab`, one file each, and what they share: exit codes, messages on stderr, and the
// options that name a scene.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/scene/document.h"

namespace clothlab::cli {

/// The program's exit codes, for scripts.
enum ExitCode : int {
  exit_done = 0,
  exit_internal = 1,
  exit_usage = 2,
  exit_no_opengl = 3,
  exit_diverged = 4
};

// Each function adds its subcommand to `app`. If the command line calls that subcommand, it runs and stores
// its exit code in `exit_code`.
void add_serve(CLI::App& app, int& exit_code);
void add_relay(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_render(CLI::App& app, int& exit_code);
void add_record(CLI::App& app, int& exit_code);
void add_chart(CLI::App& app, int& exit_code);
void add_stability(CLI::App& app, int& exit_code);
void add_choose(CLI::App& app, int& exit_code);
void add_simplify(CLI::App& app, int& exit_code);
void add_sweep(CLI::App& app, int& exit_code);
void add_validate(CLI::App& app, int& exit_code);
void add_presets(CLI::App& app, int& exit_code);
void add_fabrics(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_selftest(CLI::App& app, int& exit_code);
void add_manual(CLI::App& app, int& exit_code);

/// Prints "clothlab: error: where: what; remedy" on stderr and returns `code`.
int fail(const Error& error, ExitCode code);
/// Prints "clothlab: note: ..." on stderr.
void note(const std::string& text);

/// Accepts a whole number from `least` to `most`. CLI::Range would do, but its error messages differ between
/// versions of CLI11.
CLI::Validator whole_number(int least, int most);

/// Prints warnings on stderr, `about` before each: if the time step is near or beyond `dt_limit`, the longest
/// stable one [s], and if the thickness of self-collision is too small for the mesh.
void print_warnings(const model::Model& model, const scene::Scene& scene, double dt_limit,
                    const std::string& about = "");

/// Adds `--asset-root FOLDER`.
void add_asset_root(CLI::App& command, std::string& folder);
/// The meshes of `folder`; empty: of the folder that the scene file `scene` is in, or of the present folder
/// if it is a preset. Error: `folder` is none.
Result<std::shared_ptr<scene::FolderAssets>> folder_of_meshes(const std::string& folder,
                                                              const std::string& scene);

/// The scene a command works on: a preset's name or a file, then `--set POINTER=VALUE` in the order given.
struct SceneChoice {
  std::string name;              ///< from the command line, else the command's default
  std::vector<std::string> set;  ///< e.g. "/solver/dt=0.0005"
  std::string asset_root{};      ///< the folder of meshes; empty: see folder_of_meshes

  /// Adds S as a required positional argument, and `--set`.
  void add_positional(CLI::App& command);
  /// Adds `--scene S` with the present `name` as its default, and `--set`.
  void add_option(CLI::App& command);
  /// Loads the scene and applies every `--set`. Error: also an --asset-root that is no folder.
  Result<scene::Document> load() const;
  /// The same with meshes from `assets`.
  Result<scene::Document> load(std::shared_ptr<const scene::Assets> assets) const;
  /// The meshes that the scene may name, or an error if --asset-root is no folder.
  Result<std::shared_ptr<scene::FolderAssets>> assets() const;

 private:
  void add_set(CLI::App& command);
};

}  // namespace clothlab::cli
