#include "server/gl/reads.h"

#include <glad/gl.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/gl/buffer.h"
#include "server/gl/device_fact.h"
#include "server/gl/program.h"
#include "shaders/slots.h"

namespace clothlab::gl {

namespace {

constexpr int side = 256, group_size = 128;
/// Storage reads must be so much faster to be chosen: a kernel with many of them still reads textures, as
/// devices bind fewer storage buffers.
constexpr double clearly = 0.9;

double measure() {
  const Defines defines{{"GROUP_SIZE", std::to_string(group_size)}, {"SIDE", std::to_string(side)}};
  const Result<Program> textures = Program::load({"reads.comp"}, defines, Reads::textures),
                        storage = Program::load({"reads.comp"}, defines, Reads::storage);
  if (!textures || !storage) return 1.0;
  const TextureBuffer places(Buffer(std::vector<float>(side * side * 4, 1.0f)), GL_RGBA32F);
  const Buffer sums(side * side * 4 * sizeof(float));
  sums.bind_storage(slot_next_position);
  places.texture.bind(unit_position);
  places.buffer.bind_storage(number_of_slots + unit_position);
  const auto run = [](const Program& program) {
    return [&program](int times) {
      program.use();
      for (int i = 0; i < times; ++i) {
        glDispatchCompute(side * side / group_size, 1, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
      }
    };
  };
  const TwoTimes times = time_in_turn(run(*textures), run(*storage));
  return times.other / times.one;
}

int at_most(GLint everywhere, GLenum limit) {
  GLint allowed = 0;
  glGetIntegerv(limit, &allowed);
  return std::min(allowed, everywhere);
}

}  // namespace

double storage_over_texture_reads() {
  return device_fact("storage reads over texture reads", measure);
}

int most_storage_blocks() {
  const int allowed = at_most(16, GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
  const char* asked = std::getenv("CLOTHLAB_STORAGE_BLOCKS");
  return asked ? std::min(allowed, std::atoi(asked)) : allowed;
}

int most_textures() {
  return at_most(32, GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS);
}

Reads fastest_reads() {
  // No static variable that waits until another thread has set it: that one may wait for this one, which
  // measures something else.
  static std::atomic<std::optional<Reads>> known;
  if (const std::optional<Reads> fastest = known.load()) return *fastest;
  const char* asked = std::getenv("CLOTHLAB_READS");
  const bool storage = asked ? std::string_view(asked) == "storage" : storage_over_texture_reads() < clearly;
  GLint bindings = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
  const Reads fastest =
      storage && bindings >= number_of_slots + number_of_units ? Reads::storage : Reads::textures;
  known = fastest;
  return fastest;
}

}  // namespace clothlab::gl
