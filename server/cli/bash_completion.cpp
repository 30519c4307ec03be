// A completion for bash: CLI11 has none.
#include <algorithm>
#include <cctype>
#include <sstream>

#include "server/cli/describe.h"
#include "server/scene/document.h"

namespace clothlab::cli {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// The words that an option takes, if it says "one|another"; "F.obj|F.ply" are names of files.
std::string choices_of(const CLI::Option& option) {
  std::string value = value_of(option);
  const auto plain = [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0 || c == '|'; };
  if (value.find('|') == std::string::npos || !std::all_of(value.begin(), value.end(), plain)) return {};
  std::replace(value.begin(), value.end(), '|', ' ');
  return value;
}

bool is_scene(const CLI::Option& option) {
  return value_of(option) == "S";
}

/// The case of one subcommand: first what may follow an option that takes a value, then all options.
void complete(std::ostream& script, const CLI::App& command) {
  const std::string& name = command.get_name();
  std::vector<std::string> options, values;
  bool scene = false;
  for (const CLI::Option* option : command.get_options()) {
    scene = scene || is_scene(*option);
    for (const std::string& flag : option->get_lnames()) {
      options.push_back("--" + flag);
      const std::string choices = is_scene(*option) ? "$presets" : choices_of(*option);
      if (!choices.empty())
        script << "    " << name << ":--" << flag << ") words=\"" << choices << "\" ;;\n";
      else if (!value_of(*option).empty())
        values.push_back(name + ":--" + flag);
    }
  }
  for (const std::string& value : values) script << (&value == &values.front() ? "    " : " | ") << value;
  if (!values.empty()) script << ") ;;\n";
  script << "    " << name << ":*) words=\"" << joined(options) << (scene ? " $presets" : "") << "\" ;;\n";
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  std::vector<std::string> first;
  for (const CLI::App* command : commands_of(program)) first.push_back(command->get_name());
  for (const CLI::Option* option : program.get_options())
    for (const std::string& flag : option->get_lnames()) first.push_back("--" + flag);
  std::ostringstream script;
  script << "# Completes commands, options and presets of clothlab in bash; files where nothing else fits.\n"
            "_clothlab() {\n"
            "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words=\n"
         << "  local presets=\"" << joined(scene::preset_names()) << "\"\n"
         << "  case ${COMP_WORDS[1]}:$before in\n"
         << "    *:\"$1\") words=\"" << joined(first) << "\" ;;\n";
  for (const CLI::App* command : commands_of(program)) complete(script, *command);
  script << "  esac\n"
            "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
            "}\n"
            "complete -o default -F _clothlab clothlab\n";
  return script.str();
}

}  // namespace clothlab::cli
