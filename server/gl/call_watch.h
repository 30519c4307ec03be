// What is bound in a context, and what its commands use of it: what checked_calls.cpp has seen.
#pragma once

#include <glad/gl.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/gl/access_check.h"
#include "server/gl/program_uses.h"

namespace clothlab::gl {

class CallWatch {
 public:
  explicit CallWatch(AccessCheck::Told told) : check_(std::move(told)) {}

  // What is bound where. Names of objects as OpenGL has them.
  std::map<GLuint, GLuint> storage, uniform;              ///< buffer by binding
  std::map<GLuint, GLuint> texture_units;                 ///< texture by unit
  std::map<GLuint, GLuint> texture_buffers;               ///< buffer by texture
  std::map<GLuint, std::map<GLuint, GLuint>> attributes;  ///< buffer by binding, by vertex array
  std::map<GLuint, GLuint> elements;                      ///< buffer by vertex array
  GLuint program = 0, vertex_array = 0, indirect_arguments = 0;
  std::set<GLuint> mapped;  ///< buffers whose memory the client reads at any time
  std::map<GLuint, std::string> shader_texts, program_texts;

  void barrier(GLbitfield bits) { check_.barrier(bits); }
  void dispatch();
  void dispatch_indirect();
  void draw();
  void draw_elements();
  /// A call that is no shader's, by its name.
  void read_back(GLuint buffer, const char* call);
  void update(GLuint buffer, const char* call);
  /// What was copied to the client's memory may be read once this fence has passed.
  void fence();
  void forget_buffer(GLuint buffer);
  void forget_program(GLuint gone);

 private:
  /// The program's name, as debuggers know it.
  std::string label() const;
  std::vector<Use> uses_of_program();
  void add_vertices(std::vector<Use>& uses) const;
  void use(GLuint buffer, Access access, const char* call);

  AccessCheck check_;
  std::map<GLuint, std::vector<ProgramUse>> uses_;  ///< by program, once it has been used
  std::string last_program_;                        ///< the label of the one that ran last
};

}  // namespace clothlab::gl
