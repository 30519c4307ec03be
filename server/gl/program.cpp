#include "server/gl/program.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/base/pieces.h"
#include "server/gl/reflection.h"

namespace clothlab::gl {

namespace {

namespace fs = std::filesystem;

/// Source text with its includes and repetitions expanded, and the file and line that each of its lines came
/// from. (Some of Mesa's messages ignore the file that a #line directive names.)
struct Source {
  std::string text;
  std::vector<std::string> origins;  ///< "shaders/FILE:LINE" of each line of text

  void add_line(const std::string& line, const std::string& origin) {
    text += line + "\n";
    origins.push_back(origin);
  }
  void add(const Source& other) {
    text += other.text;
    origins.insert(origins.end(), other.origins.begin(), other.origins.end());
  }
};

class Expansion {
 public:
  Expansion(Source& source, const Defines& defines) : source_(source), defines_(defines) {}

  Status add(const std::string& path) {
    if (!seen_.insert(path).second) return ok();  // every file is included once
    Result<fs::path> found = data_path("shaders/" + path);
    if (!found) return found.error();
    Result<std::string> text = read_file(*found);
    if (!text) return text.error();

    static const std::regex include(R"(^\s*#include\s+"([^"]+)\".*$)"),
        each(R"(^\s*#each Law(?: of (\w+))?\s*$)"), end(R"(^\s*#end\s*$)");
    std::istringstream lines(*text);
    std::string line;
    std::vector<std::pair<std::string, std::string>> repeated;  // lines and their origins
    std::vector<std::string> laws;
    bool repeats = false;
    for (int number = 1; std::getline(lines, line); ++number) {
      const std::string origin = "shaders/" + path + ":" + std::to_string(number);
      std::smatch match;
      const bool directive = line.find('#') != std::string::npos;  // saves most lines the slow regex
      if (directive && std::regex_match(line, match, each)) {
        repeats = true;
        laws = names_in(match[1].matched ? match[1].str() : "LAWS");
      } else if (directive && std::regex_match(line, end)) {
        for (const std::string& law : laws)
          for (const auto& [text_of, origin_of] : repeated) source_.add_line(of_law(text_of, law), origin_of);
        repeated.clear();
        repeats = false;
      } else if (repeats) {
        repeated.emplace_back(line, origin);
      } else if (directive && std::regex_match(line, match, include)) {
        const fs::path target = (fs::path(path).parent_path() / match[1].str()).lexically_normal();
        if (Status status = add(target.string()); !status) {
          Error error = status.error();
          error.where = origin + ": " + error.where;
          return error;
        }
      } else {
        source_.add_line(line, origin);
      }
    }
    if (repeats) return Error{"shaders/" + path, "#each Law without its #end", "mend the shader"};
    return ok();
  }

 private:
  /// The names in the define `list`; none if it is not defined.
  std::vector<std::string> names_in(const std::string& list) const {
    std::vector<std::string> result;
    for (const auto& [name, value] : defines_) {
      if (name != list) continue;
      std::istringstream names(value);
      for (std::string law; names >> law;) result.push_back(law);
    }
    return result;
  }

  static std::string of_law(std::string line, const std::string& law) {
    const std::string placeholder = "Law";
    for (std::size_t at = 0; (at = line.find(placeholder, at)) != std::string::npos; at += law.size())
      line.replace(at, placeholder.size(), law);
    return line;
  }

  Source& source_;
  const Defines& defines_;
  std::set<std::string> seen_;
};

constexpr const char* other_device =
    "update the driver, or take another device (--gpu N, see `clothlab info`)";

/// The driver's first error (its first message, if none says so), with its line of the expanded text replaced
/// by the source file's name and line.
Error compile_error(const Source& source, const std::string& log) {
  const std::string remedy = "mend the shader and start again";
  if (log.empty())
    return Error{source.origins.back(), "does not compile, and the driver does not say why", other_device};
  // Mesa: "0:12(5): error: ..."; NVIDIA: "0(12) : error C0000: ..."; AMD, Intel: "ERROR: 0:12: ..."
  static const std::regex position(R"(\d+[:(](\d+)\)?(?:\(\d+\))?\s*:?\s*([^\n]*))");
  std::smatch match;
  const std::size_t first = std::min(log.find("error"), log.find("ERROR"));  // warnings may come before it
  const std::size_t line_start = first == std::string::npos ? 0 : log.rfind('\n', first) + 1;
  if (std::regex_search(log.begin() + static_cast<std::ptrdiff_t>(line_start), log.end(), match, position)) {
    const std::size_t line = std::stoul(match[1].str());
    if (line >= 1 && line <= source.origins.size())
      return Error{source.origins[line - 1], match[2].str(), remedy};
  }
  return Error{source.origins.back(), log, remedy};
}

GLenum stage_of(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  if (ending == ".vert") return GL_VERTEX_SHADER;
  if (ending == ".geom") return GL_GEOMETRY_SHADER;
  if (ending == ".frag") return GL_FRAGMENT_SHADER;
  return GL_COMPUTE_SHADER;
}

template <class Get, class GetLog>
std::string info_log(GLuint id, Get get, GetLog get_log) {
  GLint length = 0;
  get(id, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length > 0 ? length : 1), '\0');
  get_log(id, static_cast<GLsizei>(log.size()), nullptr, log.data());
  while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
  return log;
}

/// The definitions that this text, or the value of another one of them, names. Scenes that differ in the
/// others alone have the same program, which the driver's cache knows.
Defines named_in(const std::string& text, const Defines& defines) {
  const auto of_word = [](unsigned char c) { return c == '_' || std::isalnum(c) != 0; };
  std::unordered_map<std::string_view, std::size_t> unnamed;  // name without parameters: index
  std::array<bool, 256> begins{};                             // a name begins so: few words of a text do
  for (std::size_t k = 0; k < defines.size(); ++k) {
    const std::string_view name = std::string_view(defines[k].first).substr(0, defines[k].first.find('('));
    unnamed.emplace(name, k);
    begins[static_cast<unsigned char>(name.front())] = true;
  }
  std::vector<std::string_view> to_read{text};
  std::vector<bool> named(defines.size());
  while (!to_read.empty()) {
    const std::string_view read = to_read.back();
    to_read.pop_back();
    for (auto at = read.begin(); (at = std::find_if(at, read.end(), of_word)) != read.end();) {
      const auto end = std::find_if_not(at, read.end(), of_word);
      const std::string_view word(at, end);
      at = end;
      if (!begins[static_cast<unsigned char>(word.front())]) continue;
      const auto found = unnamed.find(word);
      if (found == unnamed.end()) continue;
      named[found->second] = true;
      to_read.push_back(defines[found->second].second);
      unnamed.erase(found);
    }
  }
  Defines result;
  for (std::size_t k = 0; k < defines.size(); ++k)
    if (named[k]) result.push_back(defines[k]);
  return result;
}

Result<GLuint> compile(const std::string& path, const Defines& defines, Reads reads, Source& source) {
  Source body;
  if (Status status = Expansion(body, defines).add(path); !status) return status.error();
  const std::string prologue = "shaders/" + path + ":0";
  source.add_line("#version 450 core", prologue);
  if (reads == Reads::storage) source.add_line("#define READ_STORAGE", prologue);
  for (const auto& [name, value] : named_in(body.text, defines))
    source.add_line("#define " + name + " " + value, prologue);
  source.add(body);

  const GLuint shader = glCreateShader(stage_of(path));
  const char* text = source.text.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  const std::string log = info_log(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  return compile_error(source, log);
}

thread_local ProgramWatch watch_of_thread;

/// How often a text declares something, at most: a declaration may be within an #if that is not taken.
std::size_t declared(const std::string& text, const char* pattern) {
  const std::regex declaration(pattern);
  return static_cast<std::size_t>(
      std::distance(std::sregex_iterator(text.begin(), text.end(), declaration), std::sregex_iterator()));
}

/// What a program that does not link may have too much of, against what the device allows: drivers seldom say
/// which limit it was.
std::string limits_of_device(const std::string& texts, Reads reads) {
  const auto limit = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return std::to_string(value);
  };
  const std::size_t read = declared(texts, R"(\n\s*READ_\w+\()"),
                    written = declared(texts, R"(\n\s*layout\([^)]*\)[\w ]* buffer \w+ \{)");
  const bool storage = reads == Reads::storage;
  return "its text declares at most " + std::to_string(written + (storage ? read : 0)) +
         " storage blocks, of which this device allows " + std::to_string(most_storage_blocks()) + ", and " +
         std::to_string(storage ? 0 : read) + " buffer textures, of " +
         limit(GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS) + "; a compute program may also have " +
         limit(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE) + " bytes of shared memory and " +
         limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS) + " invocations a group here";
}

}  // namespace

void watch_programs(ProgramWatch watch) {
  watch_of_thread = std::move(watch);
}

Result<Program> Program::load(std::initializer_list<std::string> paths, const Defines& defines) {
  between_pieces();
  const auto load_with_fastest_reads = [&] {
    if (fastest_reads() == Reads::storage)
      if (Result<Program> program = load(paths, defines, Reads::storage)) return program;
    return load(paths, defines, Reads::textures);
  };
  Result<Program> loaded = load_with_fastest_reads();
  if (watch_of_thread) watch_of_thread(*paths.begin(), defines, loaded);
  return loaded;
}

Result<Program> Program::load(std::initializer_list<std::string> paths, const Defines& defines, Reads reads) {
  Program program;
  program.id_ = glCreateProgram();
  std::string texts;
  for (const std::string& path : paths) {
    Source source;
    Result<GLuint> shader = compile(path, defines, reads, source);
    if (!shader) return shader.error();
    texts += source.text;
    glAttachShader(program.id_, *shader);
    glDeleteShader(*shader);  // freed with the program
  }
  glLinkProgram(program.id_);
  GLint linked = 0;
  glGetProgramiv(program.id_, GL_LINK_STATUS, &linked);
  if (!linked) {
    const std::string log = info_log(program.id_, glGetProgramiv, glGetProgramInfoLog);
    return Error{"shaders/" + *paths.begin(),
                 "does not link: " + (log.empty() ? "the driver does not say why" : log) + " (" +
                     limits_of_device(texts, reads) + ")",
                 other_device};
  }
  const auto blocks = static_cast<int>(active_resources(program.id_, GL_SHADER_STORAGE_BLOCK));
  if (blocks > most_storage_blocks())
    return Error{"shaders/" + *paths.begin(),
                 "has " + std::to_string(blocks) + " storage blocks, and a program may have " +
                     std::to_string(most_storage_blocks()) + " here",
                 other_device};
  glObjectLabel(GL_PROGRAM, program.id_, -1, paths.begin()->c_str());  // for debuggers and bench_profile
  program.list_uniforms();
  return program;
}

void Program::list_uniforms() {
  GLint count = 0, longest = 0;
  glGetProgramiv(id_, GL_ACTIVE_UNIFORMS, &count);
  glGetProgramiv(id_, GL_ACTIVE_UNIFORM_MAX_LENGTH, &longest);
  std::string name(static_cast<std::size_t>(longest), '\0');  // the 0 at its end included
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    glGetActiveUniformName(id_, i, longest, nullptr, name.data());
    const GLint location = glGetUniformLocation(id_, name.c_str());
    uniforms_.emplace(name.substr(0, name.find_first_of(std::string_view("[\0", 2))), location);
  }
}

Program::~Program() {
  if (id_) glDeleteProgram(id_);
}

}  // namespace clothlab::gl
