#include "server/sim/conjugate_gradients.h"

#include <cstddef>
#include <string>
#include <utility>

namespace clothlab::sim {

namespace {

/// Number of iterations after which a solve ends even if it has not met its tolerance. Each iteration makes
/// the error smaller, so an early end costs accuracy, not stability.
constexpr int most_iterations = 1000;
constexpr int iterations_between_looks = 8;

/// The buffer Control of shaders/methods/implicit_control.glsl.
struct Control {
  std::uint32_t groups = 0, groups_y = 1, groups_z = 1;
  std::uint32_t single = 1, single_y = 1, single_z = 1;
  std::uint32_t iterations = 0, converged = 0;
  float along = 0, kept = 0, last = 0;
  float enough = 0;
};

}  // namespace

ConjugateGradients::ConjugateGradients(const model::Model& model)
    : groups_(vertex_groups(model.vertex_count())), coarse_(model) {
  const std::size_t vector_bytes = std::size_t{model.vertex_count()} * 4 * sizeof(float);
  for (Vectors& set : vectors_)
    for (gl::TextureBuffer* vector :
         {&set.change, &set.residual, &set.preconditioned, &set.direction, &set.direction_product})
      *vector = {gl::Buffer(vector_bytes), GL_RGBA32F};
  product_ = {gl::Buffer(vector_bytes), GL_RGBA32F};
  sums_ = {gl::Buffer(groups_ * 12 * sizeof(float)), GL_RGBA32F};  // at most three vec4 per work group
  control_ = gl::Buffer(sizeof(Control));
}

gl::Defines ConjugateGradients::defines() const {
  gl::Defines defines{{"MOST_PATCHES", std::to_string(CoarseLevel::most_patches)}};
  if (groups_ <= few_groups) defines.emplace_back("FEW_GROUPS", "1");
  return defines;
}

void ConjugateGradients::set_layout(const gl::Program& program) const {
  coarse_.set_lists(program);
  program.set("group_count", static_cast<GLint>(groups_));
}

Status ConjugateGradients::load(const gl::Defines& defines) {
  for (auto [program, name] : {std::pair{&collect_, "collect"},
                               {&precondition_, "precondition"},
                               {&multiply_, "multiply"},
                               {&step_, "step"},
                               {&update_, "update"}}) {
    Result<gl::Program> loaded =
        gl::Program::load({std::string("methods/implicit_") + name + ".comp"}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    set_layout(*program);
  }
  return ok();
}

void ConjugateGradients::set_parameters(const Surroundings& around) {
  for (const gl::Program* program : {&collect_, &precondition_, &multiply_, &step_, &update_})
    set_step_uniforms(*program, around);
  coarse_.set_parameters(around.model, around.scene);
}

void ConjugateGradients::set_dt(double dt) {
  for (const gl::Program* program : {&collect_, &precondition_, &multiply_, &step_, &update_})
    program->set("dt", static_cast<float>(dt));
  coarse_.set_dt(dt);
}

void ConjugateGradients::bind() const {
  product_.bind(unit_product);
  sums_.bind(unit_group_sums);
}

Work ConjugateGradients::solve(const gl::TextureBuffer& guess, const Enough& enough, Solved& solved) {
  // Of a product of two.
  step_.set("left_share", static_cast<float>(enough.left_share * enough.left_share));
  step_.set("little", static_cast<float>(enough.little));
  Control control;
  control.groups = groups_;
  control_.upload(&control, sizeof control);
  coarse_.bind();
  dispatches_ = 0;
  for (int done = 0; done < most_iterations && control.groups > 0; done += iterations_between_looks) {
    precondition(vectors_[done % 2]);
    for (int i = 0; i < iterations_between_looks; ++i) {
      iterate(guess, done + i);
      co_await may_stop;
    }
    control_.download(&control, sizeof control);
  }
  const Vectors& last = vectors_[control.iterations % 2];
  // Whoever asked may write the next guess while it reads the solution.
  if (control.iterations == 0) vectors_[0].change.buffer.copy_from(guess.buffer);
  solved = {control.iterations, control.converged != 0, dispatches_, &last.change, &last.residual};
  solved.lost_precision = !solved.converged && control.iterations > 0 &&
                          control.iterations < static_cast<std::uint32_t>(most_iterations);
}

/// Makes the preconditioned residual from the residual alone. Iterations keep the patches' sums up to date
/// by themselves, and their rounding errors add up: in a stiff cloth a solve would end too early.
void ConjugateGradients::precondition(const Vectors& now) {
  now.residual.bind(unit_residual);
  run_if_needed(collect_, offsetof(Control, groups));
  take_step(-1);
  now.preconditioned.buffer.bind_storage(slot_preconditioned);
  run_if_needed(precondition_, offsetof(Control, groups));
}

/// Runs a program unless the solve has ended.
void ConjugateGradients::run_if_needed(const gl::Program& program, std::size_t groups) {
  program.use();
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  glDispatchComputeIndirect(static_cast<GLintptr>(groups));
  wait_for_writes();
  ++dispatches_;
}

void ConjugateGradients::take_step(int iteration) {
  control_.bind_storage(slot_solver_control);
  coarse_.bind_vectors();
  step_.set("iteration", iteration);
  run_if_needed(step_, offsetof(Control, single));
}

void ConjugateGradients::iterate(const gl::TextureBuffer& guess, int iteration) {
  const Vectors &now = vectors_[iteration % 2], &next = vectors_[(iteration + 1) % 2];
  now.residual.bind(unit_residual);
  now.preconditioned.bind(unit_preconditioned);
  product_.buffer.bind_storage(slot_product);
  run_if_needed(multiply_, offsetof(Control, groups));
  take_step(iteration);
  now.direction.bind(unit_direction);
  now.direction_product.bind(unit_direction_product);
  (iteration == 0 ? guess : now.change).bind(unit_change);
  next.residual.buffer.bind_storage(slot_residual);
  next.preconditioned.buffer.bind_storage(slot_preconditioned);
  next.direction.buffer.bind_storage(slot_direction);
  next.direction_product.buffer.bind_storage(slot_direction_product);
  next.change.buffer.bind_storage(slot_change);
  update_.set("iteration", iteration);
  run_if_needed(update_, offsetof(Control, groups));
}

}  // namespace clothlab::sim
