// Implicit Euler on the GPU: shaders/methods/implicit_*.comp. Vectors and sums stay there; the host only
// asks, now and then, whether a solve has ended.
#include <algorithm>
#include <array>
#include <cmath>

#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

/// Iterations after which a solve ends without having met its tolerance. Each makes the error smaller, so an
/// early end costs accuracy, not stability.
constexpr int most_iterations = 1000;
constexpr int iterations_between_looks = 8;

/// As in implicit_update.comp.
struct Control {
  std::uint32_t groups = 0, groups_y = 1, groups_z = 1;
  std::uint32_t iterations = 0, converged = 0;
  std::array<std::uint32_t, 3> unused{};
};

/// The least relative residual that float32 can tell: one rounding of a velocity, times the largest entry of
/// the matrix over the mass it stands beside.
double rounding_floor(const Surroundings& around) {
  const scene::Scene& scene = around.scene;
  const double dt = scene.solver.dt;
  std::vector<double> diagonal(around.model.vertex_count(), 0.0);
  for (const model::Spring& spring : around.model.springs) {
    const scene::Springs& material = scene.cloths[spring.cloth].material;
    const double share = dt * (dt * model::stiffness(material, spring.kind) + material.damping);
    diagonal[spring.a] += share;
    diagonal[spring.b] += share;
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < diagonal.size(); ++i)
    largest = std::max(largest, diagonal[i] / around.model.mass[i]);
  return 0x1p-24 * (1.0 + largest);
}

class ImplicitEuler : public Integrator {
 public:
  static Result<std::unique_ptr<Integrator>> create(std::uint32_t vertex_count, const Plan& plan) {
    std::unique_ptr<ImplicitEuler> made(new ImplicitEuler(vertex_count));
    for (auto [program, name] : {std::pair{&made->start_, "start"},
                                 {&made->system_, "system"},
                                 {&made->multiply_, "multiply"},
                                 {&made->update_, "update"},
                                 {&made->search_, "search"},
                                 {&made->advance_, "advance"},
                                 {&made->end_, "end"}}) {
      Result<gl::Program> loaded =
          gl::Program::load({std::string("methods/implicit_") + name + ".comp"}, step_defines(plan));
      if (!loaded) return loaded.error();
      *program = std::move(*loaded);
    }
    return std::unique_ptr<Integrator>(std::move(made));
  }

  void set_parameters(const Surroundings& around) override {
    for (const gl::Program* program : {&start_, &system_, &multiply_, &update_, &search_, &advance_, &end_})
      set_step_uniforms(*program, around);
    most_newton_steps_ = around.scene.solver.iterations;
    const double tolerance = std::max(around.scene.solver.tolerance, rounding_floor(around));
    glProgramUniform1f(update_.id(), update_.uniform("tolerance"), static_cast<float>(tolerance));
    for (const gl::Program* program : {&update_, &advance_})
      glProgramUniform1i(program->id(), program->uniform("group_count"), static_cast<GLint>(groups_));
  }

  void step(StateBuffers& state, int row) override {
    begin(state, row);
    for (int newton = 0; newton < most_newton_steps_; ++newton) {
      set_up(newton == 0 ? start_position_ : position_);
      const Control solved = solve();
      ++work_.newton_steps;
      work_.linear_iterations += solved.iterations;
      work_.unconverged += solved.converged ? 0 : 1;
      if (newton > 0 && solved.iterations == 0) break;  // the estimate already meets the tolerance
      advance(row);
    }
    finish(state, row);
  }

  /// No contact was found to pull.
  void restart(const StateBuffers&) override { constraint_.buffer.fill(0); }

  SolverWork work() const override { return work_; }

 private:
  explicit ImplicitEuler(std::uint32_t vertex_count) : groups_(vertex_groups(vertex_count)) {
    for (gl::TextureBuffer* vector :
         {&start_position_, &start_velocity_, &position_, &velocity_, &change_, &constraint_, &surface_,
          &residual_, &preconditioned_, &product_, &block_a_, &block_b_})
      *vector = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    direction_ = gl::Buffer(vertex_count * 4 * sizeof(float));
    direction_product_ = gl::Buffer(vertex_count * 4 * sizeof(float));
    sums_ = {gl::Buffer(groups_ * 8 * sizeof(float)), GL_RGBA32F};
    control_ = gl::Buffer(sizeof(Control) + most_iterations * 2 * sizeof(float));
  }

  void run(const gl::Program& program) {
    program.use();
    dispatch(groups_);
    wait();
  }
  static void wait() {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
  }

  void begin(const StateBuffers& state, int row) {
    state.bind_for_step();
    start_position_.buffer.bind_storage(0);
    start_velocity_.buffer.bind_storage(1);
    velocity_.buffer.bind_storage(3);
    change_.buffer.bind_storage(4);
    constraint_.buffer.bind_storage(5);
    surface_.buffer.bind_storage(6);
    glProgramUniform1i(start_.id(), start_.uniform("start_row"), row);
    run(start_);
  }

  /// The linear system at the estimate.
  void set_up(const gl::TextureBuffer& position) {
    position.bind(unit_position);
    velocity_.bind(unit_velocity);
    start_velocity_.bind(9);
    constraint_.bind(10);
    change_.bind(11);
    residual_.buffer.bind_storage(0);
    preconditioned_.buffer.bind_storage(1);
    block_a_.buffer.bind_storage(3);
    block_b_.buffer.bind_storage(4);
    run(system_);
  }

  Control solve() {
    Control control;
    control.groups = groups_;
    control_.upload(&control, sizeof control);
    for (int done = 0; done < most_iterations && control.groups > 0; done += iterations_between_looks) {
      for (int i = 0; i < iterations_between_looks; ++i) iterate(done + i);
      control_.download(&control, sizeof control);
    }
    return control;
  }

  void iterate(int iteration) {
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
    constraint_.bind(10);
    residual_.bind(11);
    preconditioned_.bind(12);
    product_.buffer.bind_storage(0);
    sums_.buffer.bind_storage(1);
    multiply_.use();
    glDispatchComputeIndirect(0);
    wait();
    product_.bind(9);
    sums_.bind(11);
    block_a_.bind(12);
    block_b_.bind(13);
    residual_.buffer.bind_storage(0);
    preconditioned_.buffer.bind_storage(1);
    control_.bind_storage(3);
    direction_.bind_storage(4);
    direction_product_.bind_storage(5);
    change_.buffer.bind_storage(6);
    update_.use();
    glUniform1i(update_.uniform("iteration"), iteration);
    glDispatchComputeIndirect(0);
    wait();
    dispatches_ += 2;
  }

  /// Line search, then the estimate takes its share of the change.
  void advance(int row) {
    start_velocity_.bind(9);
    change_.bind(11);
    sums_.buffer.bind_storage(1);
    run(search_);
    start_position_.bind(9);
    sums_.bind(10);
    residual_.bind(12);
    position_.buffer.bind_storage(0);
    velocity_.buffer.bind_storage(3);
    change_.buffer.bind_storage(4);
    constraint_.buffer.bind_storage(5);
    surface_.buffer.bind_storage(6);
    glProgramUniform1i(advance_.id(), advance_.uniform("start_row"), row);
    run(advance_);
  }

  void finish(StateBuffers& state, int row) {
    position_.bind(unit_position);
    velocity_.bind(unit_velocity);
    state.position().bind(9);
    state.velocity().bind(10);
    start_velocity_.bind(11);
    residual_.bind(12);
    surface_.bind(13);
    constraint_.bind(14);
    block_a_.bind(4);
    block_b_.bind(5);
    state.bind_outputs();
    glProgramUniform1i(end_.id(), end_.uniform("start_row"), row);
    run(end_);
    state.swap();
  }

  GLuint groups_;
  int most_newton_steps_ = 1;
  gl::Program start_, system_, multiply_, update_, search_, advance_, end_;
  gl::TextureBuffer start_position_, start_velocity_;  ///< where the step starts, with self-collision's share
  gl::TextureBuffer position_, velocity_;              ///< estimate of where it ends
  gl::TextureBuffer change_;                           ///< of the velocity: what is solved for
  gl::TextureBuffer constraint_, surface_;             ///< of the contacts with colliders
  gl::TextureBuffer residual_, preconditioned_, product_, block_a_, block_b_, sums_;
  gl::Buffer direction_, direction_product_, control_;
  SolverWork work_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_implicit_euler(std::uint32_t vertex_count, const Plan& plan) {
  return ImplicitEuler::create(vertex_count, plan);
}

}  // namespace clothlab::sim
