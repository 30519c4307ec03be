// Methods that evaluate the forces once per step, and so need one dispatch per step:
// shaders/methods/whole_step.glsl.
#include <array>
#include <string>

#include "server/scene/method.h"
#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

class WholeStep : public Integrator {
 public:
  WholeStep(gl::Program program, std::uint32_t vertex_count, bool carries)
      : program_(std::move(program)), groups_(vertex_groups(vertex_count)) {
    if (!carries) return;
    for (gl::TextureBuffer& carried : carried_)
      carried = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
  }

  void set_parameters(const Surroundings& around) override { set_step_uniforms(program_, around); }

  Work step(StateBuffers& state, int row) override {
    program_.use();
    program_.set("start_row", row);
    state.bind_for_step();
    if (carries()) {
      carried_[current_].bind(unit_carried);
      current_ = 1 - current_;
      carried_[current_].buffer.bind_storage(slot_carried);
    }
    dispatch(groups_);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    state.swap();
    return {};
  }

  /// For verlet: clears what was carried over, so that the state's velocity counts as the present velocity.
  void restart() override {
    if (carries()) carried_[current_].buffer.fill(0);
  }

  void carry(Carrier& carrier) override {
    if (carries()) carrier.buffer(carried_[current_].buffer);
  }

 private:
  gl::Program program_;
  bool carries() const { return carried_[0].buffer.bytes() > 0; }
  std::array<gl::TextureBuffer, 2>
      carried_;  ///< for verlet only, else empty; a step reads one and writes the other
  std::size_t current_ = 0;
  GLuint groups_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_whole_step(scene::Method method, std::uint32_t vertex_count,
                                                    const Plan& plan) {
  const std::string path = std::string("methods/") + scene::name(method) + ".comp";
  Result<gl::Program> program = gl::Program::load({path}, step_defines(plan));
  if (!program) return program.error();
  return std::unique_ptr<Integrator>(
      std::make_unique<WholeStep>(std::move(*program), vertex_count, method == scene::Method::verlet));
}

}  // namespace clothlab::sim
