// A linked program made from shader files below shaders/, with #include, #define and a repetition: the lines
// between `#each Law of LIST` and `#end` are repeated for each name in the define LIST, with that name in
// place of `Law`. `#each Law` alone takes the list LAWS. (GLSL has neither templates nor ##.)
#pragma once

#include <glad/gl.h>

#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/result.h"
#include "server/gl/reads.h"

namespace clothlab::gl {

using Defines = std::vector<std::pair<std::string, std::string>>;

class Program {
 public:
  Program() = default;
  /// Compiles and links `paths`, e.g. {"render/cloth.vert", "render/cloth.geom", "render/cloth.frag"} or one
  /// .comp; the stage follows from the file's ending. `defines` come right after #version 450 core. Reads
  /// storage buffers where that is fastest and the device lets a program have as many as it reads, else
  /// buffer textures. Errors: where = "shaders/FILE:LINE" of the source file, also inside an #include.
  static Result<Program> load(std::initializer_list<std::string> paths, const Defines& defines = {});
  static Result<Program> load(std::initializer_list<std::string> paths, const Defines& defines, Reads reads);
  ~Program();
  Program(Program&& other) noexcept { *this = std::move(other); }
  Program& operator=(Program&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(uniforms_, other.uniforms_);
    return *this;
  }

  void use() const { glUseProgram(id_); }
  GLuint id() const { return id_; }
  /// The location of a uniform; an array's name comes without [0]. -1 if the program does not use the
  /// uniform; glProgramUniform ignores -1.
  GLint location(std::string_view name) const {
    const auto found = uniforms_.find(name);
    return found == uniforms_.end() ? -1 : found->second;
  }
  /// Sets a uniform, if the program uses it.
  void set(std::string_view name, GLint value) const { glProgramUniform1i(id_, location(name), value); }
  void set(std::string_view name, GLfloat value) const { glProgramUniform1f(id_, location(name), value); }

 private:
  void list_uniforms();

  GLuint id_ = 0;
  std::map<std::string, GLint, std::less<>> uniforms_;  ///< locations by name, read once after linking
};

/// Told of each program that Program::load, left to choose how it reads, has loaded or not: the file that
/// names it, its defines, and the program or why there is none.
using ProgramWatch =
    std::function<void(const std::string& path, const Defines& defines, const Result<Program>& loaded)>;
/// From now on `watch` is told of the calling thread's programs; empty: nobody is.
void watch_programs(ProgramWatch watch);

}  // namespace clothlab::gl
