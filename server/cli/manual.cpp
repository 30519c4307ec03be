// `clothlab manual`: the files by which a system shows what this program can do.
#include <filesystem>
#include <memory>
#include <string>

#include "server/base/files.h"
#include "server/cli/commands.h"
#include "server/cli/describe.h"

namespace clothlab::cli {

namespace {

struct ManualArguments {
  std::filesystem::path out;
  std::string date;
};

/// A page for the program and each command, and the completion.
Status write_manual(const CLI::App& program, const ManualArguments& arguments) {
  std::error_code failure;
  std::filesystem::create_directories(arguments.out, failure);
  const std::string name = program.get_name();
  Status written = replace_file(arguments.out / (name + ".1"), manual_page(program, arguments.date));
  for (const CLI::App* command : commands_of(program))
    if (written)
      written = replace_file(arguments.out / (name + "-" + command->get_name() + ".1"),
                             manual_page(program, *command, arguments.date));
  if (written) written = replace_file(arguments.out / (name + ".bash"), bash_completion(program));
  return written;
}

}  // namespace

void add_manual(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ManualArguments>();
  CLI::App* command = app.add_subcommand("manual", "write manual pages, and a completion for bash");
  command
      ->add_option("--out", arguments->out,
                   "the folder for clothlab.1, a page for each command, and clothlab.bash")
      ->type_name("DIR")
      ->required();
  command->add_option("--date", arguments->date, "what the pages say as their date")
      ->type_name("YYYY-MM-DD")
      ->required();
  command->footer(R"(Example:
  clothlab manual --out manual --date 2026-01-31 && man -l manual/clothlab-serve.1)");
  command->callback([&app, arguments, &exit_code] {
    const Status written = write_manual(app, *arguments);
    exit_code = written ? exit_done : fail(written.error(), exit_usage);
  });
}

}  // namespace clothlab::cli
