// Picks a subcommand; everything else is in that subcommand's file.
#include <exception>
#include <iostream>

#include "server/cli/commands.h"

namespace clothlab::cli {
namespace {

constexpr const char* examples = R"(Examples:
  clothlab serve                                   the seed scene in the browser, at http://127.0.0.1:8080
  clothlab serve --scene curtain --port 9000
  clothlab run seed --time 5 --report report.json  as fast as it goes, with speed and energy
  clothlab run seed --time 2 --out cloth.obj --every 0.1 --set /solver/dt=0.0005
  clothlab render seed --time 1.5 --out seed.png
  clothlab record seed --time 10 --out seed.html   plays in any browser, without a server; .glb: elsewhere
  clothlab chart seed --out results                speed against accuracy of every method on this scene
  clothlab choose seed --tolerance 0.01            the cheapest method and step that are good enough
  clothlab validate my-scene.json
  clothlab selftest --quick                        whether this device does it right
  clothlab COMMAND --help                          the options of one command

Exit codes: 0 done, 1 internal error, 2 wrong usage or invalid scene, 3 no usable OpenGL, 4 the simulation diverged.)";

void describe(CLI::App& app, int& exit_code) {
  app.name("clothlab");
  app.set_version_flag("--version", "clothlab " CLOTHLAB_VERSION, "print the version and exit");
  app.set_help_flag("-h,--help", "print this help and exit");
  app.require_subcommand(0, 1);
  // One line for each subcommand, in the order in which the help lists them.
  add_serve(app, exit_code);
  add_relay(app, exit_code);
  add_run(app, exit_code);
  add_render(app, exit_code);
  add_record(app, exit_code);
  add_chart(app, exit_code);
  add_stability(app, exit_code);
  add_choose(app, exit_code);
  add_simplify(app, exit_code);
  add_sweep(app, exit_code);
  add_validate(app, exit_code);
  add_presets(app, exit_code);
  add_fabrics(app, exit_code);
  add_info(app, exit_code);
  add_selftest(app, exit_code);
  add_manual(app, exit_code);
  app.footer(examples);  // after the subcommands, which would inherit it
}

int usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> called = app.get_subcommands();
  const std::string command = called.empty() ? "clothlab" : "clothlab " + called.front()->get_name();
  return fail({"", error.what(), "see `" + command + " --help`"}, exit_usage);
}

int run_program(int argc, char** argv) {
  CLI::App app{"Clothlab simulates cloth on the GPU and shows it live in the browser."};
  int exit_code = exit_done;
  describe(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    return app.exit(asked, std::cout, std::cerr);
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error);
  }
  if (app.get_subcommands().empty()) {
    std::cerr << app.help() << std::flush;
    return exit_usage;
  }
  return exit_code;
}

}  // namespace
}  // namespace clothlab::cli

int main(int argc, char** argv) {
  using namespace clothlab::cli;
  int code = exit_internal;
  try {
    code = run_program(argc, argv);
  } catch (const std::exception& error) {
    code = fail({"internal", error.what(), "please report it with the command you ran"}, exit_internal);
  }
  if (!std::cout.flush())
    return fail({"stdout", "could not be written", "check the disk or the pipe"}, exit_internal);
  return code;
}
