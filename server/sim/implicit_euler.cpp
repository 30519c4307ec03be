// Implicit Euler on the GPU: shaders/methods/implicit_*.comp. Vectors and sums stay there; the host only
// asks, now and then, whether a solve has ended.
#include <array>

#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

/// Iterations after which a solve ends without having met its tolerance. Each makes the error smaller, so an
/// early end costs accuracy, not stability.
constexpr int most_iterations = 1000;
constexpr int iterations_between_looks = 8;
/// Of self-collision after the solve, each of which leaves half of an approach, or less.
constexpr int contact_passes = 4;

/// As in implicit_update.comp.
struct Control {
  std::uint32_t groups = 0, groups_y = 1, groups_z = 1;
  std::uint32_t iterations = 0, converged = 0;
  std::array<std::uint32_t, 3> unused{};
};

class ImplicitEuler : public Integrator {
 public:
  static Result<std::unique_ptr<Integrator>> create(std::uint32_t vertex_count, const Plan& plan) {
    std::unique_ptr<ImplicitEuler> made(new ImplicitEuler(vertex_count));
    gl::Defines defines = step_defines(plan);
    defines.emplace_back("GROUP_COUNT", std::to_string(made->groups_));
    if (!plan.pins && plan.solid_count() == 0) defines.emplace_back("FREE", "1");
    for (auto [program, name] : {std::pair{&made->start_, "start"},
                                 {&made->system_, "system"},
                                 {&made->multiply_, "multiply"},
                                 {&made->update_, "update"},
                                 {&made->search_, "search"},
                                 {&made->advance_, "advance"},
                                 {&made->end_, "end"}}) {
      Result<gl::Program> loaded =
          gl::Program::load({std::string("methods/implicit_") + name + ".comp"}, defines);
      if (!loaded) return loaded.error();
      *program = std::move(*loaded);
    }
    if (plan.self_collision) {
      Result<gl::Program> loaded = gl::Program::load({"methods/implicit_contacts.comp"}, defines);
      if (!loaded) return loaded.error();
      made->contacts_ = std::move(*loaded);
    }
    return std::unique_ptr<Integrator>(std::move(made));
  }

  void set_parameters(const Surroundings& around) override {
    for (const gl::Program* program :
         {&start_, &system_, &multiply_, &update_, &search_, &advance_, &end_, &contacts_})
      if (program->id()) set_step_uniforms(*program, around);
    if (around.scene.solver.dt != dt_) restart();  // the contacts' impulses are forces times dt
    dt_ = around.scene.solver.dt;
    most_newton_steps_ = around.scene.solver.iterations;
    system_.set("tolerance", static_cast<float>(around.scene.solver.tolerance));
  }

  Work step(StateBuffers& state, int row) override {
    begin(state, row);
    const Vectors* last = nullptr;
    for (int newton = 0; newton < most_newton_steps_; ++newton) {
      set_up(newton == 0 ? start_position_ : position_);
      Control solved;
      co_await solve(solved);
      ++work_.newton_steps;
      work_.linear_iterations += solved.iterations;
      work_.unconverged += solved.converged ? 0 : 1;
      if (newton > 0 && solved.iterations == 0) {  // the estimate already meets the tolerance
        last = &vectors_[0];
        break;
      }
      if (solved.iterations == 0)  // the guess is the solution; it is where the next one goes
        glCopyNamedBufferSubData(guess_.buffer.id(), vectors_[0].change.buffer.id(), 0, 0,
                                 static_cast<GLsizeiptr>(guess_.buffer.bytes()));
      last = &vectors_[solved.iterations % 2];
      advance(*last, row, newton + 1 < most_newton_steps_);
      co_await may_stop;
    }
    if (contacts_.id()) keep_apart();
    finish(state, *last, row);
  }

  /// No contact is known.
  void restart() override {
    const std::vector<float> untouched(grip_.bytes() / sizeof(float), -1.0F);
    grip_.upload(untouched.data(), grip_.bytes());
  }

  SolverWork work() const override { return work_; }

 private:
  /// What conjugate gradients carry from one iteration to the next.
  struct Vectors {
    gl::TextureBuffer change, residual, preconditioned, direction, direction_product;
  };

  explicit ImplicitEuler(std::uint32_t vertex_count) : groups_(vertex_groups(vertex_count)) {
    for (gl::TextureBuffer* vector : {&start_position_, &start_velocity_, &position_, &velocity_, &guess_,
                                      &constraint_, &surface_, &product_, &block_a_, &block_b_})
      *vector = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    for (Vectors& set : vectors_)
      for (gl::TextureBuffer* vector :
           {&set.change, &set.residual, &set.preconditioned, &set.direction, &set.direction_product})
        *vector = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    grip_ = gl::Buffer(vertex_count * 4 * sizeof(float));
    sums_ = {gl::Buffer(groups_ * 12 * sizeof(float)), GL_RGBA32F};  // three vec4 at most
    control_ = gl::Buffer(sizeof(Control) + most_iterations * 2 * sizeof(float));
  }

  void run(const gl::Program& program) {
    program.use();
    dispatch(groups_);
    wait_for_writes();
  }

  void begin(const StateBuffers& state, int row) {
    state.bind_for_step();
    start_position_.buffer.bind_storage(0);
    start_velocity_.buffer.bind_storage(1);
    velocity_.buffer.bind_storage(3);
    guess_.buffer.bind_storage(4);
    constraint_.buffer.bind_storage(5);
    surface_.buffer.bind_storage(6);
    grip_.bind_storage(7);
    start_.set("start_row", row);
    run(start_);
  }

  /// The linear system at the estimate.
  void set_up(const gl::TextureBuffer& position) {
    position.bind(unit_position);
    velocity_.bind(unit_velocity);
    start_velocity_.bind(9);
    constraint_.bind(10);
    guess_.bind(11);
    vectors_[0].residual.buffer.bind_storage(0);
    vectors_[0].preconditioned.buffer.bind_storage(1);
    block_a_.buffer.bind_storage(3);
    block_b_.buffer.bind_storage(4);
    run(system_);
  }

  /// By conjugate gradients; `control`: how that ended.
  Work solve(Control& control) {
    control = Control{};
    control.groups = groups_;
    control_.upload(&control, sizeof control);
    for (int done = 0; done < most_iterations && control.groups > 0; done += iterations_between_looks) {
      for (int i = 0; i < iterations_between_looks; ++i) {
        iterate(done + i);
        co_await may_stop;
      }
      control_.download(&control, sizeof control);
    }
  }

  void iterate(int iteration) {
    const Vectors &now = vectors_[iteration % 2], &next = vectors_[(iteration + 1) % 2];
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
    constraint_.bind(10);
    now.residual.bind(11);
    now.preconditioned.bind(12);
    product_.buffer.bind_storage(0);
    sums_.buffer.bind_storage(1);
    multiply_.use();
    glDispatchComputeIndirect(0);
    wait_for_writes();
    now.residual.bind(16);
    now.preconditioned.bind(17);
    now.direction.bind(18);
    now.direction_product.bind(19);
    (iteration == 0 ? guess_ : now.change).bind(20);
    product_.bind(9);
    sums_.bind(11);
    block_a_.bind(12);
    block_b_.bind(13);
    next.residual.buffer.bind_storage(0);
    next.preconditioned.buffer.bind_storage(1);
    control_.bind_storage(3);
    next.direction.buffer.bind_storage(4);
    next.direction_product.buffer.bind_storage(5);
    next.change.buffer.bind_storage(6);
    update_.use();
    update_.set("iteration", iteration);
    glDispatchComputeIndirect(0);
    wait_for_writes();
    dispatches_ += 2;
  }

  /// Line search, then the estimate takes its share of the change.
  void advance(const Vectors& solved, int row, bool another) {
    start_velocity_.bind(9);
    solved.change.bind(11);
    sums_.buffer.bind_storage(1);
    run(search_);
    start_position_.bind(9);
    sums_.bind(10);
    solved.residual.bind(12);
    position_.buffer.bind_storage(0);
    velocity_.buffer.bind_storage(3);
    guess_.buffer.bind_storage(4);
    constraint_.buffer.bind_storage(5);
    surface_.buffer.bind_storage(6);
    start_velocity_.buffer.bind_storage(1);
    grip_.bind_storage(7);
    advance_.set("start_row", row);
    advance_.set("another", another ? 1 : 0);
    run(advance_);
  }

  /// The velocities go back and forth between two buffers, and end in the one they came from.
  void keep_apart() {
    static_assert(contact_passes % 2 == 0);
    start_position_.bind(9);
    position_.buffer.bind_storage(0);
    for (int pass = 0; pass < contact_passes; ++pass) {
      (pass % 2 == 0 ? velocity_ : guess_).bind(unit_velocity);
      (pass % 2 == 0 ? guess_ : velocity_).buffer.bind_storage(3);
      run(contacts_);
    }
  }

  void finish(StateBuffers& state, const Vectors& solved, int row) {
    position_.bind(unit_position);
    velocity_.bind(unit_velocity);
    state.position().bind(9);
    state.velocity().bind(10);
    start_velocity_.bind(11);
    solved.residual.bind(12);
    surface_.bind(13);
    constraint_.bind(14);
    grip_.bind_storage(7);
    state.bind_outputs();
    end_.set("start_row", row);
    run(end_);
    state.swap();
  }

  GLuint groups_;
  double dt_ = 0;
  int most_newton_steps_ = 1;
  gl::Program start_, system_, multiply_, update_, search_, advance_, end_, contacts_;
  gl::TextureBuffer start_position_, start_velocity_;  ///< where the step starts, with self-collision's share
  gl::TextureBuffer position_, velocity_;              ///< estimate of where it ends
  gl::TextureBuffer guess_;                            ///< of the change of velocity that is solved for
  gl::TextureBuffer constraint_, surface_;             ///< of the contacts with colliders
  gl::Buffer grip_;                                    ///< of these, kept from step to step
  gl::TextureBuffer block_a_, block_b_, product_, sums_;
  std::array<Vectors, 2> vectors_;  ///< each iteration reads one set and writes the other
  gl::Buffer control_;
  SolverWork work_;
};

}  // namespace

Result<std::unique_ptr<Integrator>> make_implicit_euler(std::uint32_t vertex_count, const Plan& plan) {
  return ImplicitEuler::create(vertex_count, plan);
}

}  // namespace clothlab::sim
