#include "server/gl/checked_calls.h"

#include <glad/egl.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "server/gl/call_watch.h"

namespace clothlab::gl {

namespace {

std::mutex mutex;
std::function<void(const std::string&)> watcher;

void tell(const std::string& fault) {
  const std::lock_guard lock(mutex);
  if (watcher) return watcher(fault);
  std::fprintf(stderr, "clothlab: CLOTHLAB_CHECK_BARRIERS: %s\n", fault.c_str());
  std::abort();
}

/// What is known of the current context. An entry stays when its context has gone: another one of the same
/// address begins anew in it.
CallWatch& current() {
  static std::mutex of_map;
  static std::map<EGLContext, CallWatch> contexts;
  const std::lock_guard lock(of_map);
  return contexts.try_emplace(eglGetCurrentContext(), tell).first->second;
}

bool asks(const char* variable, std::string_view value) {
  const char* asked = std::getenv(variable);
  return asked && asked == value;
}
bool checks_barriers() {
  return asks("CLOTHLAB_CHECK_BARRIERS", "1");
}
bool reverses_groups() {
  return asks("CLOTHLAB_GROUP_ORDER", "reversed");
}

constexpr const char* reversed_groups =
    "#define gl_WorkGroupID (gl_NumWorkGroups - 1u - gl_WorkGroupID)\n"
    "#define gl_GlobalInvocationID (gl_WorkGroupID * gl_WorkGroupSize + gl_LocalInvocationID)\n";

/// The text of a compute shader with its groups in the other order; of others as it is.
std::string in_order(GLuint shader, std::string text) {
  GLint stage = 0;
  glGetShaderiv(shader, GL_SHADER_TYPE, &stage);
  if (stage == GL_COMPUTE_SHADER) text.insert(text.find('\n') + 1, reversed_groups);
  return text;
}

/// A function of ours that has the type of the driver's: `Sees` sees the call, then the driver gets it.
template <class Function, auto Sees>
struct Checked;
template <class Returned, class... Arguments, auto Sees>
struct Checked<Returned(GLAD_API_PTR*)(Arguments...), Sees> {
  static inline Returned(GLAD_API_PTR* drivers)(Arguments...) = nullptr;
  static Returned GLAD_API_PTR call(Arguments... arguments) {
    Sees(current(), arguments...);
    return drivers(arguments...);
  }
};

struct Call {
  std::string_view name;
  GLADapiproc ours;
  GLADapiproc* drivers;
};

template <class Function, auto Sees>
Call checked(const char* name) {
  using Of = Checked<Function, Sees>;
  return {name, reinterpret_cast<GLADapiproc>(&Of::call), reinterpret_cast<GLADapiproc*>(&Of::drivers)};
}

using Watch = CallWatch;

const Call calls_of_buffers[] = {
    checked<PFNGLGETNAMEDBUFFERSUBDATAPROC,
            [](Watch& watch, GLuint buffer, auto...) { watch.read_back(buffer, "glGetNamedBufferSubData"); }>(
        "glGetNamedBufferSubData"),
    checked<PFNGLNAMEDBUFFERSUBDATAPROC,
            [](Watch& watch, GLuint buffer, auto...) { watch.update(buffer, "glNamedBufferSubData"); }>(
        "glNamedBufferSubData"),
    checked<PFNGLCLEARNAMEDBUFFERDATAPROC,
            [](Watch& watch, GLuint buffer, auto...) { watch.update(buffer, "glClearNamedBufferData"); }>(
        "glClearNamedBufferData"),
    checked<PFNGLCOPYNAMEDBUFFERSUBDATAPROC,
            [](Watch& watch, GLuint from, GLuint to, auto...) {
              watch.read_back(from, "glCopyNamedBufferSubData");
              watch.update(to, "glCopyNamedBufferSubData");
            }>("glCopyNamedBufferSubData"),
    checked<PFNGLMAPNAMEDBUFFERRANGEPROC,
            [](Watch& watch, GLuint buffer, auto...) {
              watch.read_back(buffer, "glMapNamedBufferRange");
              watch.mapped.insert(buffer);
            }>("glMapNamedBufferRange"),
    checked<PFNGLDELETEBUFFERSPROC,
            [](Watch& watch, GLsizei count, const GLuint* buffers) {
              for (GLsizei i = 0; i < count; ++i) watch.forget_buffer(buffers[i]);
            }>("glDeleteBuffers"),
};

const Call calls_that_bind[] = {
    checked<PFNGLBINDBUFFERPROC,
            [](Watch& watch, GLenum target, GLuint buffer) {
              if (target == GL_DISPATCH_INDIRECT_BUFFER) watch.indirect_arguments = buffer;
            }>("glBindBuffer"),
    checked<PFNGLBINDBUFFERBASEPROC,
            [](Watch& watch, GLenum target, GLuint binding, GLuint buffer) {
              if (target == GL_SHADER_STORAGE_BUFFER) watch.storage[binding] = buffer;
              if (target == GL_UNIFORM_BUFFER) watch.uniform[binding] = buffer;
            }>("glBindBufferBase"),
    checked<PFNGLBINDTEXTUREUNITPROC,
            [](Watch& watch, GLuint unit, GLuint texture) { watch.texture_units[unit] = texture; }>(
        "glBindTextureUnit"),
    checked<PFNGLTEXTUREBUFFERPROC, [](Watch& watch, GLuint texture, GLenum,
                                       GLuint buffer) { watch.texture_buffers[texture] = buffer; }>(
        "glTextureBuffer"),
    checked<PFNGLDELETETEXTURESPROC,
            [](Watch& watch, GLsizei count, const GLuint* textures) {
              for (GLsizei i = 0; i < count; ++i) watch.texture_buffers.erase(textures[i]);
            }>("glDeleteTextures"),
    checked<PFNGLBINDVERTEXARRAYPROC, [](Watch& watch, GLuint array) { watch.vertex_array = array; }>(
        "glBindVertexArray"),
    checked<PFNGLVERTEXARRAYVERTEXBUFFERPROC, [](Watch& watch, GLuint array, GLuint binding, GLuint buffer,
                                                 auto...) { watch.attributes[array][binding] = buffer; }>(
        "glVertexArrayVertexBuffer"),
    checked<PFNGLVERTEXARRAYELEMENTBUFFERPROC,
            [](Watch& watch, GLuint array, GLuint buffer) { watch.elements[array] = buffer; }>(
        "glVertexArrayElementBuffer"),
    checked<PFNGLDELETEVERTEXARRAYSPROC,
            [](Watch& watch, GLsizei count, const GLuint* arrays) {
              for (GLsizei i = 0; i < count; ++i) {
                watch.attributes.erase(arrays[i]);
                watch.elements.erase(arrays[i]);
              }
            }>("glDeleteVertexArrays"),
};

const Call calls_of_programs[] = {
    checked<PFNGLUSEPROGRAMPROC, [](Watch& watch, GLuint program) { watch.program = program; }>(
        "glUseProgram"),
    checked<PFNGLATTACHSHADERPROC,
            [](Watch& watch, GLuint program, GLuint shader) {
              watch.program_texts[program] += watch.shader_texts[shader];
            }>("glAttachShader"),
    checked<PFNGLDELETESHADERPROC, [](Watch& watch, GLuint shader) { watch.shader_texts.erase(shader); }>(
        "glDeleteShader"),
    checked<PFNGLDELETEPROGRAMPROC, [](Watch& watch, GLuint program) { watch.forget_program(program); }>(
        "glDeleteProgram"),
    checked<PFNGLDISPATCHCOMPUTEPROC,
            [](Watch& watch, GLuint x, GLuint y, GLuint z) {
              if (x != 0 && y != 0 && z != 0) watch.dispatch();
            }>("glDispatchCompute"),
    checked<PFNGLDISPATCHCOMPUTEINDIRECTPROC, [](Watch& watch, GLintptr) { watch.dispatch_indirect(); }>(
        "glDispatchComputeIndirect"),
    checked<PFNGLDRAWARRAYSPROC, [](Watch& watch, auto...) { watch.draw(); }>("glDrawArrays"),
    checked<PFNGLMULTIDRAWARRAYSPROC, [](Watch& watch, auto...) { watch.draw(); }>("glMultiDrawArrays"),
    checked<PFNGLDRAWELEMENTSPROC, [](Watch& watch, auto...) { watch.draw_elements(); }>("glDrawElements"),
    checked<PFNGLMEMORYBARRIERPROC, [](Watch& watch, GLbitfield bits) { watch.barrier(bits); }>(
        "glMemoryBarrier"),
    checked<PFNGLFENCESYNCPROC, [](Watch& watch, auto...) { watch.fence(); }>("glFenceSync"),
};

/// Where programs are made of texts, both variables have something to do.
const Call shader_source = checked<PFNGLSHADERSOURCEPROC, [](Watch& watch, GLuint shader, GLsizei&,
                                                             const GLchar* const*& texts, const GLint*&) {
  thread_local std::string text;
  thread_local const GLchar* changed = nullptr;
  text = reverses_groups() ? in_order(shader, texts[0]) : texts[0];
  watch.shader_texts[shader] = text;
  changed = text.c_str();
  texts = &changed;
}>("glShaderSource");

const Call* call_of(std::string_view name) {
  if (name == shader_source.name && (checks_barriers() || reverses_groups())) return &shader_source;
  if (!checks_barriers()) return nullptr;
  const auto in = [&](const auto& calls) -> const Call* {
    for (const Call& call : calls)
      if (call.name == name) return &call;
    return nullptr;
  };
  for (const Call* found : {in(calls_of_buffers), in(calls_that_bind), in(calls_of_programs)})
    if (found) return found;
  return nullptr;
}

}  // namespace

GLADapiproc function_of(const char* name) {
  const auto drivers = reinterpret_cast<GLADapiproc>(eglGetProcAddress(name));
  const Call* call = call_of(name);
  if (!call) return drivers;
  *call->drivers = drivers;
  return call->ours;
}

void begin_context_checks() {
  if (checks_barriers()) current() = CallWatch(tell);
}

void watch_barriers(std::function<void(const std::string&)> told) {
  const std::lock_guard lock(mutex);
  watcher = std::move(told);
}

}  // namespace clothlab::gl
