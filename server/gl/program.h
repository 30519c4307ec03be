// A linked program made from shader files below shaders/, with #include, #define and a repetition: the lines
// between `#each Law` and `#end` are there once for each name that the define LAWS lists, with that name in
// the place of Law. (GLSL has neither templates nor ##.)
#pragma once

#include <glad/gl.h>

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "server/base/result.h"

namespace clothlab::gl {

using Defines = std::vector<std::pair<std::string, std::string>>;

class Program {
 public:
  Program() = default;
  /// Compiles and links `paths`, e.g. {"render/cloth.vert", "render/cloth.geom", "render/cloth.frag"} or one
  /// .comp; the stage follows from the file's ending. `defines` come right after #version 450 core. Errors:
  /// where = "shaders/FILE:LINE" of the source file, also inside an #include.
  static Result<Program> load(std::initializer_list<std::string> paths, const Defines& defines = {});
  ~Program();
  Program(Program&& other) noexcept { std::swap(id_, other.id_); }
  Program& operator=(Program&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  void use() const { glUseProgram(id_); }
  GLuint id() const { return id_; }
  /// -1 where the uniform is not used, which glUniform ignores.
  GLint uniform(const char* name) const { return glGetUniformLocation(id_, name); }

 private:
  GLuint id_ = 0;
};

}  // namespace clothlab::gl
