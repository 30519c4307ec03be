// The classical Runge-Kutta method: four dispatches of shaders/methods/rk4.comp.
#include <array>

#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

class Rk4 : public Integrator {
 public:
  explicit Rk4(std::array<gl::Program, 4> stages, std::uint32_t vertex_count)
      : stages_(std::move(stages)), groups_(vertex_groups(vertex_count)) {
    const auto per_vertex = [&] {
      return gl::TextureBuffer(gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F);
    };
    for (Between& between : between_) between = {per_vertex(), per_vertex()};
    for (gl::TextureBuffer& slope : slopes_) slope = per_vertex();
  }

  void set_parameters(const Surroundings& around) override {
    for (const gl::Program& stage : stages_) set_step_uniforms(stage, around);
  }

  Work step(StateBuffers& state, int row) override {
    state.bind_for_step();
    state.position().bind(unit_start_position);
    state.velocity().bind(unit_start_velocity);
    for (std::size_t stage = 0; stage < 4; ++stage) {
      if (at_stage_) at_stage_(shares[stage]);
      if (stage > 0) between_[(stage - 1) % 2].bind_for_reading();
      if (stage < 3) {
        between_[stage % 2].bind_for_writing();
        slopes_[stage].buffer.bind_storage(slot_slope);
      } else {
        slopes_[0].bind(unit_slope_1);
        slopes_[1].bind(unit_slope_2);
        slopes_[2].bind(unit_slope_3);
        state.bind_outputs();
      }
      stages_[stage].use();
      stages_[stage].set("start_row", row);
      dispatch(groups_);
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    }
    state.swap();
    return {};
  }

 private:
  /// An intermediate state, between the step's start and its end.
  struct Between {
    gl::TextureBuffer position, velocity;
    void bind_for_reading() const {
      position.bind(unit_position);
      velocity.bind(unit_velocity);
    }
    void bind_for_writing() const {
      position.buffer.bind_storage(slot_next_position);
      velocity.buffer.bind_storage(slot_next_velocity);
    }
  };

  static constexpr std::array shares{0.0, 0.5, 0.5, 1.0};  ///< of the step, at the stages
  std::array<gl::Program, 4> stages_;
  std::array<Between, 2> between_;
  std::array<gl::TextureBuffer, 3> slopes_;
  GLuint groups_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_rk4(std::uint32_t vertex_count, const Plan& plan) {
  std::array<gl::Program, 4> stages;
  for (std::size_t stage = 0; stage < 4; ++stage) {
    gl::Defines defines = step_defines(plan);
    defines.emplace_back("STAGE", std::to_string(stage + 1));
    Result<gl::Program> program = gl::Program::load({"methods/rk4.comp"}, defines);
    if (!program) return program.error();
    stages[stage] = std::move(*program);
  }
  return std::unique_ptr<Integrator>(std::make_unique<Rk4>(std::move(stages), vertex_count));
}

}  // namespace clothlab::sim
