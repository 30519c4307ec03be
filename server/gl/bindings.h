// Keeps what is bound for compute in the current context (program, buffers, textures), to bind it again after
// other work has bound something else.
#pragma once

#include <glad/gl.h>

#include <array>

#include "shaders/slots.h"

namespace clothlab::gl {

class Bindings {
 public:
  /// The present bindings. The driver knows them itself, so that nothing waits for the GPU.
  static Bindings current();
  /// Binds the kept objects again, except those that have been deleted since.
  void restore() const;

 private:
  static constexpr GLuint texture_units = number_of_units, storage_slots = number_of_slots + number_of_units;
  GLint program_ = 0, indirect_ = 0, uniform_ = 0;  // one uniform block: contact between surfaces
  std::array<GLint, texture_units> textures_{};
  std::array<GLint, storage_slots> storage_{};
};

}  // namespace clothlab::gl
