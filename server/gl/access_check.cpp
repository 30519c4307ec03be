#include "server/gl/access_check.h"

#include <bit>

namespace clothlab::gl {

namespace {

struct Barrier {
  GLbitfield bit;
  const char* name;
};

/// What must stand between a shader's write and this.
Barrier barrier_before(Access access) {
  switch (access) {
    case Access::storage_read:
    case Access::storage_write:
      return {GL_SHADER_STORAGE_BARRIER_BIT, "GL_SHADER_STORAGE_BARRIER_BIT"};
    case Access::texture:
      return {GL_TEXTURE_FETCH_BARRIER_BIT, "GL_TEXTURE_FETCH_BARRIER_BIT"};
    case Access::uniform:
      return {GL_UNIFORM_BARRIER_BIT, "GL_UNIFORM_BARRIER_BIT"};
    case Access::command:
      return {GL_COMMAND_BARRIER_BIT, "GL_COMMAND_BARRIER_BIT"};
    case Access::attribute:
      return {GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT, "GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT"};
    case Access::element:
      return {GL_ELEMENT_ARRAY_BARRIER_BIT, "GL_ELEMENT_ARRAY_BARRIER_BIT"};
    case Access::read_back:
    case Access::update:
      return {GL_BUFFER_UPDATE_BARRIER_BIT, "GL_BUFFER_UPDATE_BARRIER_BIT"};
    case Access::mapped:
      return {GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT, "GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT"};
  }
  return {0, ""};
}

/// Whether a later command's write through a storage block must wait for this: commands that are no shader's
/// are carried out in their order by themselves.
bool is_read_of_shader(Access access) {
  switch (access) {
    case Access::storage_read:
    case Access::texture:
    case Access::uniform:
    case Access::command:
    case Access::attribute:
    case Access::element:
      return true;
    default:
      return false;
  }
}

}  // namespace

void AccessCheck::barrier(GLbitfield bits) {
  ++now_;
  for (std::size_t i = 0; i < bits_of_barriers; ++i)
    if (bits >> i & 1u) last_barrier_[i] = now_;
}

bool AccessCheck::passed(const Event& event, GLbitfield bit) const {
  return event.at == 0 || last_barrier_[static_cast<std::size_t>(std::countr_zero(bit))] > event.at;
}

void AccessCheck::check(const Use& use, const Buffer& buffer) {
  const Barrier needed = barrier_before(use.access);
  const auto tell = [&](const char* what, const Event& before, const char* then) {
    told_(before.place + what + use.place + then + ", without " + needed.name + " between them");
  };
  const bool writes = use.access == Access::storage_write || use.access == Access::update;
  if (!passed(buffer.shader_wrote, needed.bit))
    tell(" writes what ", buffer.shader_wrote, writes ? " writes again" : " reads");
  else if (use.access == Access::storage_write && !passed(buffer.shader_read, needed.bit))
    tell(" reads what ", buffer.shader_read, " writes");
}

void AccessCheck::command(std::span<const Use> uses) {
  ++now_;
  for (const Use& use : uses)
    if (const auto found = buffers_.find(use.buffer); found != buffers_.end()) check(use, found->second);
  for (const Use& use : uses) {
    if (use.access == Access::storage_write) buffers_[use.buffer].shader_wrote = {now_, use.place};
    if (is_read_of_shader(use.access)) buffers_[use.buffer].shader_read = {now_, use.place};
  }
}

}  // namespace clothlab::gl
