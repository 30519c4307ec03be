#include "server/sim/strain_limit.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "server/model/limit_shares.h"

namespace clothlab::sim {

namespace {

constexpr int most_sweeps = 512;
constexpr int sweeps_between_looks = 8;

/// The buffer Control in shaders/strain_limit/sweep.comp.
struct LimitControl {
  std::uint32_t groups = 0, groups_y = 1, groups_z = 1;
  std::uint32_t sweeps = 0;
};

/// The relaxation factor of the sweeps. Jacobi's iteration converges with a factor below 2 / e, where e is
/// the largest eigenvalue of the springs' coupling. Whatever the masses, e is at most the largest eigenvalue
/// of sum n n^T over the springs of any one vertex (n: a spring's direction), since
/// (a - b)^2 / (v + w) <= a^2 / v + b^2 / w. The largest row sum, used here, is a bound of that eigenvalue.
/// 1.6 instead of 2 leaves a margin for springs that turn.
float relaxation(const model::Model& model) {
  std::vector<glm::dmat3> coupling(model.vertex_count(), glm::dmat3(0.0));
  for (const model::Spring& spring : model.springs()) {
    const auto [a, b] = spring.vertices;
    const glm::dvec3 d = model.rest_position[a] - model.rest_position[b];
    const double squared = glm::dot(d, d);
    if (!(squared > 0.0)) continue;
    const glm::dmat3 share = glm::outerProduct(d, d) / squared;
    coupling[a] += share;
    coupling[b] += share;
  }
  double largest = 1.0;
  for (const glm::dmat3& c : coupling)
    for (int row = 0; row < 3; ++row)
      largest = std::max(largest, std::abs(c[0][row]) + std::abs(c[1][row]) + std::abs(c[2][row]));
  return static_cast<float>(1.6 / largest);
}

}  // namespace

Result<StrainLimit> StrainLimit::create(const Surroundings& around, const Plan& plan, std::size_t entries) {
  StrainLimit made;
  gl::Defines defines = step_defines(plan);
  const std::uint32_t count = around.model.vertex_count();
  made.groups_ = vertex_groups(count);
  if (made.groups_ <= few_groups) defines.emplace_back("FEW_GROUPS", "1");
  defines.emplace_back("CLOTH_COUNT", std::to_string(around.scene.cloths.size()));
  if (plan.limits_springs) defines.emplace_back("SPRINGS", "1");
  if (plan.limits_sheets) {
    defines.emplace_back("SHEETS", "1");
    made.threads_ = ThreadLimit(around.model, around.scene);
  }
  for (auto [program, path] : {std::pair{&made.start_, "strain_limit/start.comp"},
                               {&made.sweep_, "strain_limit/sweep.comp"},
                               {&made.end_, "strain_limit/end.comp"}}) {
    Result<gl::Program> loaded = gl::Program::load({path}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
  }
  made.sweep_.set("group_count", static_cast<GLint>(made.groups_));
  for (gl::TextureBuffer& position : made.position_)
    position = {gl::Buffer(count * 4 * sizeof(float)), GL_RGBA32F};
  for (gl::TextureBuffer& excess : made.group_excess_)
    excess = {gl::Buffer(made.groups_ * 4 * sizeof(float)), GL_RGBA32F};
  made.pulls_ = gl::Buffer(std::max<std::size_t>(entries, 1) * sizeof(float));
  made.pull_impulses_ = gl::Buffer(count * 4 * sizeof(float));
  made.control_ = gl::Buffer(sizeof(LimitControl));
  if (plan.limits_springs) made.sweep_.set("relaxation", relaxation(around.model));
  made.set_parameters(around);
  return made;
}

void StrainLimit::set_parameters(const Surroundings& around) {
  for (const gl::Program* program : {&start_, &sweep_, &end_}) set_step_uniforms(*program, around);
  std::vector<float> limits;
  for (const scene::Cloth& cloth : around.scene.cloths) {
    const scene::StrainLimit limit = cloth.strain_limit().value_or(-1.0);
    limits.push_back(static_cast<float>(limit.warp));
    limits.push_back(static_cast<float>(limit.weft));
  }
  glProgramUniform2fv(sweep_.id(), sweep_.location("limit"), static_cast<GLsizei>(limits.size() / 2),
                      limits.data());
  if (threads_) threads_->set_parameters(around.model);
  // The pulls carried over are forces times dt^2.
  if (around.scene.solver.dt != dt_) restart();
  dt_ = around.scene.solver.dt;
}

void StrainLimit::restart() {
  doubted_ = false;
  pulls_.fill(0);
  if (threads_) threads_->restart();
}

void StrainLimit::carry(Carrier& carrier) {
  carrier.buffer(pulls_);
  carrier.number(doubted_);
  if (threads_) threads_->carry(carrier);
}

std::vector<float> StrainLimit::shares(const StateBuffers& state, const model::Model& model,
                                       const gl::TextureBuffer& corrected) const {
  const auto read = [&](const gl::TextureBuffer& from, std::vector<glm::dvec3>& into) {
    std::vector<glm::vec4> rows(model.vertex_count());
    from.buffer.download(rows.data(), rows.size() * sizeof(glm::vec4));
    into.assign(rows.begin(), rows.end());
    return rows;
  };
  model::LimitedStep step;
  step.dt = dt_;
  for (const glm::vec4& row : read(state.position(), step.free)) step.inverse_mass.push_back(row.w);
  read(state.velocity(), step.free_velocity);
  read(state.previous_position(), step.start);
  read(state.previous_velocity(), step.start_velocity);
  read(corrected, step.limited);
  std::vector<float> shares;
  for (const model::LimitShare& share : model::limit_shares(model, step)) {
    shares.push_back(static_cast<float>(share.place));
    shares.push_back(static_cast<float>(share.velocity));
  }
  return shares;
}

Work StrainLimit::apply(StateBuffers& state, const model::Model& model) {
  state.position().bind(unit_position);
  state.previous_position().bind(unit_start_position);
  position_[0].buffer.bind_storage(slot_next_position);
  pulls_.bind_storage(slot_pulls);
  pull_impulses_.bind_storage(slot_given);
  if (threads_) threads_->bind();
  start_.use();
  glDispatchCompute(groups_, 1, 1);
  wait_for_writes();

  LimitControl control;
  control.groups = groups_;
  control_.upload(&control, sizeof control);
  sweep_.use();
  control_.bind_storage(slot_limit_control);
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  for (int done = 0; done < most_sweeps && control.groups > 0; done += sweeps_between_looks) {
    for (int sweep = done; sweep < done + sweeps_between_looks; ++sweep) {
      const auto from = static_cast<std::size_t>(sweep) % 2, to = 1 - from;
      position_[from].bind(unit_position);
      group_excess_[from].bind(unit_group_excess);
      position_[to].buffer.bind_storage(slot_next_position);
      group_excess_[to].buffer.bind_storage(slot_group_excess);
      sweep_.set("sweep", sweep);
      glDispatchComputeIndirect(0);
      wait_for_writes();
      co_await may_stop;
    }
    control_.download(&control, sizeof control);
  }
  work_.sweeps += control.sweeps;
  work_.unconverged += control.groups > 0 ? 1 : 0;

  const gl::TextureBuffer& corrected = position_[control.sweeps % 2];
  std::vector<float> taken(2 * model.cloths.size(), 1.0F);
  if (doubted_ || control.groups > 0) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    taken = shares(state, model, corrected);
  }
  state.bind_for_step();
  corrected.bind(unit_corrected_position);
  end_.use();
  glProgramUniform2fv(end_.id(), end_.location("shares"), static_cast<GLsizei>(model.cloths.size()),
                      taken.data());
  glDispatchCompute(groups_, 1, 1);
  wait_for_writes();
  state.swap();
  // If the limits cannot be met, the pulls grow without bound: the next step must not begin with them.
  const bool kept = control.groups == 0 &&
                    std::all_of(taken.begin(), taken.end(), [](float share) { return share == 1.0F; });
  if (!kept) restart();
  doubted_ = !kept;
}

}  // namespace clothlab::sim
