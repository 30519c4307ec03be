#include "server/selftest/needs.h"

#include <algorithm>
#include <array>

#include "server/gl/buffer.h"
#include "server/gl/reads.h"
#include "server/gl/reflection.h"

namespace clothlab::selftest {

namespace {

struct Limit {
  const char* name;
  GLenum value;  ///< asked for by glGetIntegerv
};
constexpr const char* storage_blocks = "storage blocks of a compute program";
constexpr const char* storage_bindings = "places to bind storage buffers";
constexpr const char* textures = "textures of a compute program";
constexpr const char* texture_units = "places to bind textures";
constexpr const char* uniform_blocks = "uniform blocks of a compute program";
constexpr const char* invocations = "invocations of a work group";
constexpr const char* texels = "texels of a buffer texture";
constexpr std::array limits_of_device{
    Limit{storage_blocks, GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS},
    Limit{storage_bindings, GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS},
    Limit{textures, GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS},
    Limit{texture_units, GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS},
    Limit{uniform_blocks, GL_MAX_COMPUTE_UNIFORM_BLOCKS},
    Limit{invocations, GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS},
    Limit{texels, GL_MAX_TEXTURE_BUFFER_SIZE},
};

bool is_sampler(GLenum type) {
  constexpr std::array samplers{GL_SAMPLER_BUFFER, GL_INT_SAMPLER_BUFFER, GL_UNSIGNED_INT_SAMPLER_BUFFER,
                                GL_SAMPLER_2D, GL_SAMPLER_2D_SHADOW};
  return std::find(samplers.begin(), samplers.end(), static_cast<int>(type)) != samplers.end();
}

}  // namespace

ProgramWatch::ProgramWatch() {
  gl::watch_programs([this](const std::string& path, const gl::Defines& defines,
                            const Result<gl::Program>& loaded) { add(path, defines, loaded); });
}

ProgramWatch::~ProgramWatch() {
  gl::watch_programs({});
}

void ProgramWatch::add(const std::string& path, const gl::Defines& defines,
                       const Result<gl::Program>& loaded) {
  if (!loaded) return;  // whoever wanted it says so
  std::string key = path;
  for (const auto& [name, value] : defines) key += "\n" + name + " " + value;
  if (linked_.insert(key).second) measure("shaders/" + path, loaded->id());
}

void ProgramWatch::need(const char* what, GLint count, const std::string& program) {
  Most& most = most_[what];
  if (count > most.needed) most = {count, program};
}

void ProgramWatch::measure(const std::string& path, GLuint id) {
  const auto count = [&](GLenum kind) { return static_cast<GLint>(gl::active_resources(id, kind)); };
  for (GLuint i = 0; i < gl::active_resources(id, GL_SHADER_STORAGE_BLOCK); ++i)
    need(storage_bindings, 1 + gl::resource_property(id, GL_SHADER_STORAGE_BLOCK, i, GL_BUFFER_BINDING),
         path);
  GLint samplers = 0;
  for (GLuint index = 0; index < gl::active_resources(id, GL_UNIFORM); ++index) {
    if (!is_sampler(static_cast<GLenum>(gl::resource_property(id, GL_UNIFORM, index, GL_TYPE)))) continue;
    samplers += gl::resource_property(id, GL_UNIFORM, index, GL_ARRAY_SIZE);
    GLint unit = 0;
    glGetUniformiv(id, gl::resource_property(id, GL_UNIFORM, index, GL_LOCATION), &unit);
    need(texture_units, 1 + unit, path);
  }
  if (!path.ends_with(".comp")) return;
  need(storage_blocks, count(GL_SHADER_STORAGE_BLOCK), path);
  need(textures, samplers, path);
  need(uniform_blocks, count(GL_UNIFORM_BLOCK), path);
  std::array<GLint, 3> group{1, 1, 1};
  glGetProgramiv(id, GL_COMPUTE_WORK_GROUP_SIZE, group.data());
  need(invocations, group[0] * group[1] * group[2], path);
}

std::vector<Check> ProgramWatch::limits() const {
  std::vector<Check> checks;
  for (const Limit& limit : limits_of_device) {
    const auto found = most_.find(limit.name);
    Most most = found == most_.end() ? Most{} : found->second;
    if (limit.value == GL_MAX_TEXTURE_BUFFER_SIZE)
      most = {static_cast<GLint>(gl::most_texels()), "the largest list of a preset"};
    GLint allowed = 0;
    glGetIntegerv(limit.value, &allowed);
    if (limit.value == GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS) allowed = gl::most_storage_blocks();
    if (limit.value == GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS) allowed = gl::most_textures();
    const bool passed = most.needed <= allowed;
    checks.push_back({std::string("limit: ") + limit.name, passed, most.needed, allowed, "",
                      std::to_string(most.needed) + " needed (" + most.program + "), " +
                          std::to_string(allowed) + " allowed",
                      passed ? "" : "update this device's driver, or take another device (--gpu N)"});
  }
  return checks;
}

}  // namespace clothlab::selftest
