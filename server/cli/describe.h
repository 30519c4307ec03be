// The program's commands and options as other programs show them, from what CLI11 knows of each.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace clothlab::cli {

/// The subcommands in the order in which the help lists them.
std::vector<const CLI::App*> commands_of(const CLI::App& program);
/// "PORT" of an option that takes a value, without what its validators add; empty for a flag.
std::string value_of(const CLI::Option& option);

/// The manual page of the program, section 1, as roff. `date` is 2026-01-31, of the page.
std::string manual_page(const CLI::App& program, const std::string& date);
/// The manual page of one of its subcommands.
std::string manual_page(const CLI::App& program, const CLI::App& command, const std::string& date);

/// A script for bash that completes commands, options, presets where a scene is asked for, and files.
std::string bash_completion(const CLI::App& program);

}  // namespace clothlab::cli
