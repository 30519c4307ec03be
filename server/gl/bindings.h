// What is bound for compute in the current context, to be put back after other work has bound something else.
#pragma once

#include <glad/gl.h>

#include <array>

#include "shaders/slots.h"

namespace clothlab::gl {

class Bindings {
 public:
  /// Those of now. Asks the driver's client side only: nothing waits for the GPU.
  static Bindings now();
  /// Objects that have gone since stay unbound.
  void restore() const;

 private:
  static constexpr GLuint texture_units = number_of_units, storage_slots = number_of_slots + number_of_units;
  GLint program_ = 0, indirect_ = 0;
  std::array<GLint, texture_units> textures_{};
  std::array<GLint, storage_slots> storage_{};
};

}  // namespace clothlab::gl
