#include "server/sim/diagnose.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/sim/element_lists.h"
#include "server/sim/plan.h"

namespace clothlab::sim {

namespace {

/// The partial result of one work group, laid out as in diagnose.comp.
struct Partial {
  float kinetic, elastic, gravitational, contacts;
  float strain, speed_squared, not_finite, unused;
  float pin_force, contact_force, contact_mass, unused_too;
};

}  // namespace

Result<DiagnosticsPass> DiagnosticsPass::create(std::uint32_t vertex_count) {
  DiagnosticsPass pass;
  LawSet all_laws;
  all_laws.fill(true);
  gl::Defines defines = law_defines(all_laws);
  defines.emplace_back("GROUP_SIZE", std::to_string(group_size));
  Result<gl::Program> program = gl::Program::load({"diagnose.comp"}, defines);
  if (!program) return program.error();
  pass.program_ = std::move(*program);
  pass.program_.set("vertex_count", static_cast<GLint>(vertex_count));
  pass.groups_ = vertex_groups(vertex_count);
  pass.results_ = gl::Buffer(pass.groups_ * sizeof(Partial) + sizeof(SelfCollision::Counters) +
                             SurfaceContact::bytes_of_counts);
  pass.ring_ = gl::ReadbackRing(pass.results_.bytes(), ring_slots);
  return pass;
}

void DiagnosticsPass::request(const StateBuffers& state, const SelfCollision* self_collision,
                              const SurfaceContact* surfaces, const glm::dvec3& gravity, double time,
                              std::uint64_t step) {
  if (ring_.full() && !ring_.front(true).empty()) take(arrived_.emplace_back());
  if (ring_.full()) return;  // the device is lost
  program_.use();
  glUniform4f(program_.location("gravity"), static_cast<float>(gravity.x), static_cast<float>(gravity.y),
              static_cast<float>(gravity.z), 0.0f);
  state.shown_position().bind(unit_position);
  state.shown_velocity().bind(unit_velocity);
  results_.bind_storage(slot_partials);
  glDispatchCompute(groups_, 1, 1);
  // The next step may write over the state that this reads.
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
  if (self_collision)
    glCopyNamedBufferSubData(self_collision->control().id(), results_.id(), SelfCollision::counters_offset,
                             static_cast<GLintptr>(groups_ * sizeof(Partial)),
                             sizeof(SelfCollision::Counters));
  if (surfaces) surfaces->copy_counts(results_, groups_ * sizeof(Partial) + sizeof(SelfCollision::Counters));
  ring_.push(results_, results_.bytes());
  pending_[requested_++ % ring_slots] = {time, step, self_collision != nullptr, surfaces != nullptr};
}

bool DiagnosticsPass::poll(Diagnostics& out, bool wait) {
  if (!arrived_.empty()) {
    out = arrived_.front();
    arrived_.pop_front();
    return true;
  }
  if (ring_.front(wait).empty()) return false;
  take(out);
  return true;
}

/// The oldest result in the ring, which has arrived.
void DiagnosticsPass::take(Diagnostics& out) {
  const std::span<const std::byte> bytes = ring_.front(true);
  out = Diagnostics{};
  const Pending& pending = pending_[delivered_++ % ring_slots];
  out.time = pending.time;
  out.step = pending.step;
  double contacts = 0.0, speed_squared = 0.0;
  for (std::size_t group = 0; group < groups_; ++group) {
    Partial partial;
    std::memcpy(&partial, bytes.data() + group * sizeof(partial), sizeof(partial));
    out.kinetic += partial.kinetic;
    out.elastic += partial.elastic;
    out.gravitational += partial.gravitational;
    contacts += partial.contacts;
    out.pin_force += partial.pin_force;
    out.contact_force += partial.contact_force;
    out.contact_mass += partial.contact_mass;
    out.max_strain = std::max(out.max_strain, static_cast<double>(partial.strain));
    speed_squared = std::max(speed_squared, static_cast<double>(partial.speed_squared));
    out.finite = out.finite && partial.not_finite == 0.0f;
  }
  const std::byte* counts = bytes.data() + groups_ * sizeof(Partial);
  if (pending.self_collision) {
    SelfCollision::Counters counters;
    std::memcpy(&counters, counts, sizeof(counters));
    out.neighbour_rebuilds = counters.rebuilds;
    out.neighbours_dropped = counters.dropped;
  }
  if (pending.surfaces) {
    const SurfaceContact::Counters surfaces =
        SurfaceContact::read_counts(counts + sizeof(SelfCollision::Counters));
    out.surface_pairs = surfaces.pairs;
    out.surface_cuts = surfaces.cuts;
    out.surface_forced = surfaces.forced;
    out.surface_not_taken = surfaces.not_taken;
    out.surface_searches = surfaces.rebuilds;
  }
  out.contacts = static_cast<std::uint32_t>(contacts);
  out.max_speed = std::sqrt(speed_squared);
  ring_.pop();
}

}  // namespace clothlab::sim
