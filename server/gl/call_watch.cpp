#include "server/gl/call_watch.h"

#include <array>

namespace clothlab::gl {

namespace {

GLuint value_at(const std::map<GLuint, GLuint>& map, GLuint key) {
  const auto found = map.find(key);
  return found == map.end() ? 0 : found->second;
}

}  // namespace

std::string CallWatch::label() const {
  std::array<char, 256> text{};
  glGetObjectLabel(GL_PROGRAM, program, static_cast<GLsizei>(text.size()), nullptr, text.data());
  return text[0] ? std::string("shaders/") + text.data() : "program " + std::to_string(program);
}

std::vector<Use> CallWatch::uses_of_program() {
  const auto known = uses_.find(program);
  const std::vector<ProgramUse>& of_program =
      known != uses_.end() ? known->second : uses_[program] = uses_of(program, program_texts[program]);
  const std::string name = label();
  last_program_ = name;
  std::vector<Use> uses;
  for (const ProgramUse& one : of_program) {
    const std::string place = name + " (" + one.name + ")";
    switch (one.kind) {
      case ProgramUse::Kind::storage:
        uses.push_back(
            {value_at(storage, one.place), one.writes ? Access::storage_write : Access::storage_read, place});
        break;
      case ProgramUse::Kind::uniform:
        uses.push_back({value_at(uniform, one.place), Access::uniform, place});
        break;
      case ProgramUse::Kind::texture:
        uses.push_back(
            {value_at(texture_buffers, value_at(texture_units, one.place)), Access::texture, place});
        break;
    }
  }
  return uses;
}

void CallWatch::dispatch() {
  check_.command(uses_of_program());
}

void CallWatch::dispatch_indirect() {
  std::vector<Use> uses = uses_of_program();
  uses.push_back({indirect_arguments, Access::command, last_program_ + " (number of groups)"});
  check_.command(uses);
}

void CallWatch::add_vertices(std::vector<Use>& uses) const {
  const auto found = attributes.find(vertex_array);
  if (found == attributes.end()) return;
  for (const auto& [binding, buffer] : found->second)
    uses.push_back(
        {buffer, Access::attribute, last_program_ + " (attribute " + std::to_string(binding) + ")"});
}

void CallWatch::draw() {
  std::vector<Use> uses = uses_of_program();
  add_vertices(uses);
  check_.command(uses);
}

void CallWatch::draw_elements() {
  std::vector<Use> uses = uses_of_program();
  add_vertices(uses);
  uses.push_back({value_at(elements, vertex_array), Access::element, last_program_ + " (indices)"});
  check_.command(uses);
}

void CallWatch::use(GLuint buffer, Access access, const char* call) {
  const Use one{buffer, access, std::string(call) + " after " + last_program_};
  check_.command({&one, 1});
}

void CallWatch::read_back(GLuint buffer, const char* call) {
  use(buffer, Access::read_back, call);
}

void CallWatch::update(GLuint buffer, const char* call) {
  use(buffer, Access::update, call);
}

void CallWatch::fence() {
  for (const GLuint buffer : mapped) use(buffer, Access::mapped, "glFenceSync");
}

void CallWatch::forget_buffer(GLuint buffer) {
  check_.forget(buffer);
  mapped.erase(buffer);
  for (auto* bound : {&storage, &uniform, &texture_buffers, &elements})
    std::erase_if(*bound, [&](const auto& entry) { return entry.second == buffer; });
  for (auto& [array, bound] : attributes)
    std::erase_if(bound, [&](const auto& entry) { return entry.second == buffer; });
  if (indirect_arguments == buffer) indirect_arguments = 0;
}

void CallWatch::forget_program(GLuint gone) {
  uses_.erase(gone);
  program_texts.erase(gone);
}

}  // namespace clothlab::gl
