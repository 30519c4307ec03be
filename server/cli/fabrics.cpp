// `clothlab fabrics`: the fabrics that a scene may name, what they are like, and where their numbers are
// from.
#include <iomanip>
#include <iostream>
#include <memory>

#include "server/cli/commands.h"
#include "server/scene/fabrics.h"

namespace clothlab::cli {

void add_fabrics(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("fabrics", "list the fabrics that a scene may name");
  auto sources = std::make_shared<bool>(false);
  command->add_flag("--sources", *sources, "with where the numbers are from");
  command->callback([&exit_code, sources] {
    const auto& all = scene::fabrics();
    if (!all) {
      std::cerr << all.error().text() << "\n";
      exit_code = exit_internal;
      return;
    }
    for (const scene::Fabric& fabric : *all) {
      std::cout << std::left << std::setw(15) << fabric.name << fabric.feel << "\n";
      if (*sources) std::cout << std::setw(15) << "" << fabric.source << "\n";
    }
    exit_code = exit_done;
  });
}

}  // namespace clothlab::cli
