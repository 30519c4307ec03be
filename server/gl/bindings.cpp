#include "server/gl/bindings.h"

#include <algorithm>

namespace clothlab::gl {

namespace {

GLuint limit(GLenum name, GLuint ours) {
  GLint most = 0;
  glGetIntegerv(name, &most);
  return std::min(ours, static_cast<GLuint>(most));
}

}  // namespace

Bindings Bindings::current() {
  Bindings bound;
  glGetIntegerv(GL_CURRENT_PROGRAM, &bound.program_);
  glGetIntegerv(GL_DISPATCH_INDIRECT_BUFFER_BINDING, &bound.indirect_);
  const GLuint units = limit(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, texture_units);
  for (GLuint unit = 0; unit < units; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    glGetIntegerv(GL_TEXTURE_BINDING_BUFFER, &bound.textures_[unit]);
  }
  const GLuint slots = limit(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, storage_slots);
  for (GLuint slot = 0; slot < slots; ++slot)
    glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, slot, &bound.storage_[slot]);
  glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, slot_known_control, &bound.uniform_);
  return bound;
}

void Bindings::restore() const {
  glUseProgram(static_cast<GLuint>(program_));
  const auto buffer = [](GLint id) {
    return glIsBuffer(static_cast<GLuint>(id)) ? static_cast<GLuint>(id) : 0;
  };
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer(indirect_));
  for (GLuint unit = 0; unit < texture_units; ++unit)
    if (glIsTexture(static_cast<GLuint>(textures_[unit])))
      glBindTextureUnit(unit, static_cast<GLuint>(textures_[unit]));
  for (GLuint slot = 0; slot < storage_slots; ++slot)
    if (storage_[slot] != 0) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, buffer(storage_[slot]));
  if (uniform_ != 0) glBindBufferBase(GL_UNIFORM_BUFFER, slot_known_control, buffer(uniform_));
}

}  // namespace clothlab::gl
