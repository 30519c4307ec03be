#include "server/gl/program_uses.h"

#include <array>
#include <cctype>
#include <cstddef>
#include <string_view>

#include "server/gl/reflection.h"

namespace clothlab::gl {

namespace {

std::string name_of(GLuint program, GLenum interface, GLuint index) {
  std::array<char, 256> name{};
  glGetProgramResourceName(program, interface, index, static_cast<GLsizei>(name.size()), nullptr,
                           name.data());
  return name.data();
}

/// Whether a text has `readonly buffer BLOCK`. What shaders/access.glsl declares is `name##_reads` there.
bool is_readonly(const std::string& texts, const std::string& block) {
  constexpr std::string_view suffix = "_reads";
  if (block.ends_with(suffix) && texts.find("readonly buffer name##_reads") != std::string::npos) return true;
  const std::string declared = "readonly buffer " + block;
  for (std::size_t at = 0; (at = texts.find(declared, at)) != std::string::npos; at += declared.size()) {
    const char after = texts[at + declared.size()];
    if (!std::isalnum(static_cast<unsigned char>(after)) && after != '_') return true;
  }
  return false;
}

bool is_buffer_texture(GLenum type) {
  return type == GL_SAMPLER_BUFFER || type == GL_INT_SAMPLER_BUFFER || type == GL_UNSIGNED_INT_SAMPLER_BUFFER;
}

}  // namespace

std::vector<ProgramUse> uses_of(GLuint program, const std::string& texts) {
  std::vector<ProgramUse> uses;
  const auto blocks = [&](GLenum interface, ProgramUse::Kind kind, const std::string& what) {
    for (GLuint i = 0; i < active_resources(program, interface); ++i) {
      const std::string name = name_of(program, interface, i);
      const auto place = static_cast<GLuint>(resource_property(program, interface, i, GL_BUFFER_BINDING));
      uses.push_back(
          {kind, place, kind == ProgramUse::Kind::storage && !is_readonly(texts, name), what + name});
    }
  };
  blocks(GL_SHADER_STORAGE_BLOCK, ProgramUse::Kind::storage, "storage block ");
  blocks(GL_UNIFORM_BLOCK, ProgramUse::Kind::uniform, "uniform block ");
  for (GLuint i = 0; i < active_resources(program, GL_UNIFORM); ++i) {
    if (!is_buffer_texture(static_cast<GLenum>(resource_property(program, GL_UNIFORM, i, GL_TYPE)))) continue;
    GLint unit = 0;
    glGetUniformiv(program, resource_property(program, GL_UNIFORM, i, GL_LOCATION), &unit);
    uses.push_back({ProgramUse::Kind::texture, static_cast<GLuint>(unit), false,
                    "buffer texture " + name_of(program, GL_UNIFORM, i)});
  }
  return uses;
}

}  // namespace clothlab::gl
