// What OpenGL tells of a linked program.
#pragma once

#include <glad/gl.h>

namespace clothlab::gl {

/// Number of its active resources of a kind, e.g. GL_SHADER_STORAGE_BLOCK.
inline GLuint active_resources(GLuint program, GLenum interface) {
  GLint count = 0;
  glGetProgramInterfaceiv(program, interface, GL_ACTIVE_RESOURCES, &count);
  return static_cast<GLuint>(count);
}

/// One property of one of them.
inline GLint resource_property(GLuint program, GLenum interface, GLuint index, GLenum which) {
  GLint value = 0;
  glGetProgramResourceiv(program, interface, index, 1, &which, 1, nullptr, &value);
  return value;
}

}  // namespace clothlab::gl
