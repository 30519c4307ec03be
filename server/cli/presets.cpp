// `clothlab presets`: the scenes that come with the program.
#include <iomanip>
#include <iostream>

#include "server/cli/commands.h"

namespace clothlab::cli {

void add_presets(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("presets", "list the scenes that come with the program");
  command->callback([&exit_code] {
    for (const scene::Preset& preset : scene::presets())
      std::cout << std::left << std::setw(17) << preset.name << preset.description << "\n";
    exit_code = exit_done;
  });
}

}  // namespace clothlab::cli
