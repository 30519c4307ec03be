#include "server/sim/bdf2.h"

#include <cstddef>
#include <glm/geometric.hpp>
#include <utility>

namespace clothlab::sim {

namespace {

void run(const gl::Program& program, GLuint groups) {
  program.use();
  glDispatchCompute(groups, 1, 1);
  wait_for_writes();
}

}  // namespace

Result<Bdf2> Bdf2::create(const model::Model& model, const Plan& plan, const gl::Defines& defines) {
  Bdf2 made;
  made.groups_ = vertex_groups(model.vertex_count());
  made.may_meet_ = plan.solid_count() > 0 || plan.self_collision || plan.surface_contact() || plan.wind;
  Result<gl::Program> keep = gl::Program::load({"methods/bdf2_keep.comp"}, defines);
  if (!keep) return keep.error();
  made.keep_ = std::move(*keep);
  if (plan.wind) {
    Result<gl::Program> expect = gl::Program::load({"methods/bdf2_expect.comp"}, defines);
    if (!expect) return expect.error();
    made.expect_ = std::move(*expect);
  }
  for (gl::TextureBuffer& history : made.history_)
    history = {gl::Buffer(std::size_t{model.vertex_count()} * 2 * 4 * sizeof(float)), GL_RGBA32F};
  made.met_ = gl::Buffer(sizeof(std::uint32_t));
  return made;
}

void Bdf2::set_parameters(const Surroundings& around) {
  step_length_ = around.scene.solver.dt;
  for (const gl::Program* program : {&keep_, &expect_})
    if (program->id()) set_step_uniforms(*program, around);
  keep_.set("step_length", static_cast<float>(step_length_));
  keep_.set("impact", static_cast<float>(2.0 * step_length_ * glm::length(around.scene.gravity)));
}

void Bdf2::begin(bool held) {
  held_ = held;
  by_formula_ = holds_ && !held;
}

bool Bdf2::begin_by_implicit_euler() {
  return std::exchange(by_formula_, false);
}

void Bdf2::put_aside(const std::vector<const gl::Buffer*>& changed) {
  if (!may_meet_) return;
  aside_.resize(changed.size());
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (aside_[i].bytes() != changed[i]->bytes()) aside_[i] = gl::Buffer(changed[i]->bytes());
    aside_[i].copy_from(*changed[i]);
  }
}

void Bdf2::put_back(const std::vector<gl::Buffer*>& changed) const {
  for (std::size_t i = 0; i < changed.size(); ++i) changed[i]->copy_from(aside_[i]);
}

void Bdf2::bind_begin(const gl::Program& start) const {
  history_[0].bind(unit_history);
  start.set("history_share", by_formula_ ? 1.0F / 3.0F : 0.0F);
  const double last = (last_by_formula_ ? 2.0 / 3.0 : 1.0) * step_length_;
  start.set("grip_scale", static_cast<float>(dt() / last));
}

void Bdf2::expect(const gl::TextureBuffer& position, const gl::TextureBuffer& velocity) const {
  bind_begin(expect_);
  position.buffer.bind_storage(slot_next_position);
  velocity.buffer.bind_storage(slot_next_velocity);
  run(expect_, groups_);
}

bool Bdf2::look(const StateBuffers& state, const gl::TextureBuffer& wind_loads, int row) {
  state.position().bind(unit_before_position);
  state.velocity().bind(unit_before_velocity);
  state.previous_position().bind(unit_position);
  state.previous_velocity().bind(unit_velocity);
  history_[0].bind(unit_history);
  if (expect_.id()) {
    wind_loads.bind(unit_wind);
    keep_.set("start_row", row);
  }
  history_[1].buffer.bind_storage(slot_history);
  std::uint32_t met = 0;
  met_.upload(&met, sizeof met);
  met_.bind_storage(slot_met);
  run(keep_, groups_);
  if (may_meet_) met_.download(&met, sizeof met);
  return met != 0;
}

void Bdf2::accept(bool smooth) {
  std::swap(history_[0], history_[1]);
  last_by_formula_ = by_formula_;
  holds_ = smooth && !held_;
}

void Bdf2::restart() {
  holds_ = last_by_formula_ = false;
  history_[0].buffer.fill(0);
}

void Bdf2::carry(Carrier& carrier) {
  carrier.buffer(history_[0].buffer);
  carrier.number(holds_);
  carrier.number(last_by_formula_);
}

}  // namespace clothlab::sim
