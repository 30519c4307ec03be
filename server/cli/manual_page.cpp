// Manual pages in roff's man macros, which man and mandoc read.
#include <cctype>
#include <sstream>

#include "server/cli/describe.h"

namespace clothlab::cli {

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

std::string value_of(const CLI::Option& option) {
  if (option.get_type_size() == 0) return {};
  const std::string name = option.get_type_name();
  return name.substr(0, name.find(':'));
}

namespace {

/// The text as roff prints it: what roff has a meaning for, or sets as another sign, is named.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\e";
        break;
      case '-':
        out += "\\-";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      default:
        out += c;
    }
  }
  return out.rfind('.', 0) == 0 ? "\\&" + out : out;
}

/// What stands below a help, sorted: examples as they are typed, and text.
struct Footer {
  std::string examples, notes;
};

bool indented(const std::string& line) {
  return line.rfind("  ", 0) == 0;
}

Footer footer_of(const CLI::App& app) {
  Footer footer;
  std::string* into = &footer.notes;
  bool typed = false, begins = false;  // between .EX and .EE; the next line begins a paragraph
  std::istringstream lines(app.get_footer());
  for (std::string line; std::getline(lines, line);) {
    const bool title = line.rfind("Example", 0) == 0 && line.back() == ':';
    if (indented(line) != typed) *into += typed ? ".EE\n" : ".EX\n";
    begins = begins || typed || title || line.empty();
    typed = indented(line);
    if (typed) *into += roff(line.substr(2)) + "\n";
    if (typed || line.empty()) continue;
    into = title ? &footer.examples : &footer.notes;
    if (line == "Example:" || line == "Examples:") continue;
    *into += (begins && !into->empty() ? ".PP\n" : "") + roff(line) + "\n";
    begins = false;
  }
  if (typed) *into += ".EE\n";
  return footer;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

/// What an option is called where it is described: "-h, --help", "--port PORT", or the name of an argument.
std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "" : ", ") + bold("-" + name);
  for (const std::string& name : option.get_lnames())
    names += (names.empty() ? "" : ", ") + bold("--" + name);
  const std::string value = value_of(option);
  if (names.empty()) return italic(value);
  return value.empty() ? names : names + " " + italic(value);
}

void describe(std::ostream& page, const CLI::Option& option) {
  page << ".TP\n" << names_of(option) << "\n" << roff(option.get_description());
  if (!option.get_default_str().empty()) page << " (" << roff(option.get_default_str()) << " if not given)";
  if (!option.get_envname().empty()) page << " (or " << bold(option.get_envname()) << " in the environment)";
  page << ".\n";
}

/// The options under a heading for each of their groups; arguments without a name in front come first.
void describe_options(std::ostream& page, const CLI::App& app) {
  const auto positional = [](const CLI::Option* option) { return !option->nonpositional(); };
  const auto arguments = app.get_options(positional);
  if (!arguments.empty()) page << ".SH ARGUMENTS\n";
  for (const CLI::Option* option : arguments) describe(page, *option);
  for (const std::string& group : app.get_groups()) {
    std::string heading;
    for (const char c : group) heading += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    page << ".SH " << heading << "\n";
    for (const CLI::Option* option : app.get_options())
      if (option->get_group() == group && option->nonpositional()) describe(page, *option);
  }
}

void begin(std::ostream& page, const std::string& name, const std::string& date, const std::string& what) {
  std::string title;
  for (const char c : name) title += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  page << ".TH " << title << " 1 " << date << " \"Clothlab " CLOTHLAB_VERSION "\" \"User Commands\"\n"
       << ".SH NAME\n"
       << name << " \\- " << roff(what) << "\n.SH SYNOPSIS\n";
}

void end(std::ostream& page, const CLI::App& app) {
  const Footer footer = footer_of(app);
  if (!footer.notes.empty()) page << ".SH NOTES\n" << footer.notes;
  if (!footer.examples.empty()) page << ".SH EXAMPLES\n" << footer.examples;
}

std::string page_name(const CLI::App& program, const CLI::App& command) {
  return program.get_name() + "-" + command.get_name();
}

}  // namespace

std::string manual_page(const CLI::App& program, const std::string& date) {
  std::ostringstream page;
  begin(page, program.get_name(), date, "cloth simulated on the GPU, shown live in the browser");
  page << bold(program.get_name()) << " " << italic("COMMAND") << " [" << italic("OPTION") << "]...\n"
       << ".SH DESCRIPTION\n"
       << roff(program.get_description()) << "\n.SH COMMANDS\n";
  for (const CLI::App* command : commands_of(program))
    page << ".TP\n" << bold(command->get_name()) << "\n" << roff(command->get_description()) << ".\n";
  describe_options(page, program);
  end(page, program);
  page << ".SH SEE ALSO\n";
  const char* before = "";
  for (const CLI::App* command : commands_of(program)) {
    page << before << bold(page_name(program, *command)) << "(1)";
    before = ",\n";
  }
  page << "\n";
  return page.str();
}

std::string manual_page(const CLI::App& program, const CLI::App& command, const std::string& date) {
  std::ostringstream page;
  begin(page, page_name(program, command), date, command.get_description());
  page << bold(program.get_name() + " " + command.get_name()) << " [" << italic("OPTION") << "]...";
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const std::string argument =
        italic(value_of(*option)) + (option->get_items_expected_max() > 1 ? "..." : "");
    page << " " << (option->get_required() ? argument : "[" + argument + "]");
  }
  page << "\n";
  describe_options(page, command);
  end(page, command);
  page << ".SH SEE ALSO\n" << bold(program.get_name()) << "(1)\n";
  return page.str();
}

}  // namespace clothlab::cli
