#include "server/stream/field_pass.h"

#include <cmath>
#include <string>
#include <utility>

#include "server/sim/element_lists.h"
#include "server/sim/plan.h"
#include "shaders/slots.h"

namespace clothlab::stream {

namespace {

constexpr std::size_t peaks_bytes = 2 * sizeof(std::uint32_t);

/// The time in which a range falls to 0.37 of itself once the cloth is still [s], simulated. It is longer
/// than a swing of a cloth of a metre, which is still twice in each.
constexpr double falls_in = 2.0;

/// The share of a peak that still counts after `passed` [s]. Time goes back when a scene starts anew.
float kept_after(double passed) {
  return passed >= 0 ? static_cast<float>(std::exp(-passed / falls_in)) : 0.0f;
}

}  // namespace

Result<FieldPass> FieldPass::create() {
  FieldPass pass;
  sim::LawSet all_laws;
  all_laws.fill(true);
  for (const FieldFacts& each : fields) {
    gl::Defines defines = sim::law_defines(all_laws);
    defines.emplace_back("GROUP_SIZE", std::to_string(sim::group_size));
    defines.emplace_back(each.define, "1");
    Result<gl::Program> program = gl::Program::load({"stream/field.comp"}, defines);
    if (!program) return program.error();
    pass.programs_[index_of(each.field)] = std::move(*program);
  }
  return pass;
}

void FieldPass::set_mesh(std::uint32_t vertex_count) {
  vertex_count_ = vertex_count;
  for (Values& values : values_) values = {};
}

void FieldPass::compute(const sim::Simulation& simulation, Field field, const gl::Program& reader) {
  Values& values = values_[index_of(field)];
  if (values.buffer.bytes() == 0)  // all 0: no peak before
    values.buffer = gl::Buffer(peaks_bytes + vertex_count_ * sizeof(float));
  values.turn = 1 - values.turn;
  const double now = simulation.time();
  const float kept = kept_after(now - std::exchange(values.time, now));
  const std::uint32_t none = 0;
  values.buffer.upload(&none, sizeof none, static_cast<std::size_t>(values.turn) * sizeof none);

  const gl::Program& program = programs_[index_of(field)];
  program.use();
  program.set("vertex_count", static_cast<GLint>(vertex_count_));
  program.set("shuffled", static_cast<GLint>(simulation.bind_vertices()));
  program.set("kept", kept);
  program.set("turn", values.turn);
  values.buffer.bind_storage(slot_field);
  glDispatchCompute(sim::vertex_groups(vertex_count_), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  reader.set("turn", values.turn);
  reader.set("least_range", fields[index_of(field)].least_range);
}

}  // namespace clothlab::stream
