#include "server/sim/implicit_passes.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "server/sim/surface_contact.h"

namespace clothlab::sim {

namespace {

/// Passes of self-collision after the solve. Each pass leaves half of the speed at which two vertices
/// approach each other, or less.
constexpr int contact_passes = 4;
constexpr std::uint32_t trends = 3;  ///< TRENDS in implicit_euler.glsl

}  // namespace

ImplicitPasses::ImplicitPasses(const model::Model& model, const Plan& plan)
    : groups_(vertex_groups(model.vertex_count())),
      touches_(plan.solid_count() > 0 && !plan.contact_term()),
      solver_(model) {
  const std::size_t vertex_count = model.vertex_count();
  for (gl::TextureBuffer* vector : {&start_position_, &start_velocity_, &position_, &velocity_, &guess_,
                                    &constraint_, &surface_, &block_a_, &block_b_})
    *vector = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
  for (gl::TextureBuffer* of_each : {&trends_, &trend_products_})
    *of_each = {gl::Buffer(vertex_count * trends * 4 * sizeof(float)), GL_RGBA32F};
  if (!plan.contact_term()) {
    still_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
    still_.buffer.fill(0);
  } else {
    first_change_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
  }
  past_velocities_ = gl::Buffer(vertex_count * trends * 4 * sizeof(float));
  contact_friction_ = gl::Buffer(vertex_count * 4 * sizeof(float));
}

Status ImplicitPasses::load_own(gl::Program& program, const char* name, const gl::Defines& defines) {
  Result<gl::Program> loaded =
      gl::Program::load({std::string("methods/implicit_") + name + ".comp"}, defines);
  if (!loaded) return loaded.error();
  program = std::move(*loaded);
  solver_.set_layout(program);
  return ok();
}

Status ImplicitPasses::load(const model::Model& model, const Plan& plan) {
  gl::Defines defines = step_defines(plan);
  for (gl::Defines::value_type& define : solver_.defines()) defines.push_back(std::move(define));
  if (plan.contact_term()) defines.emplace_back("CONTACT_TERM", "1");
  if (plan.method == scene::Method::bdf2) {
    defines.emplace_back("BDF2", "1");
    Result<Bdf2> bdf2 = Bdf2::create(model, plan, defines);
    if (!bdf2) return bdf2.error();
    bdf2_ = std::move(*bdf2);
  }
  if (!plan.pins && plan.solid_count() == 0 && plan.bodies == 0) defines.emplace_back("FREE", "1");
  std::vector<std::pair<gl::Program*, const char*>> wanted{
      {&start_, "start"},   {&system_, "system"},   {&project_, "project"}, {&improve_, "improve"},
      {&search_, "search"}, {&advance_, "advance"}, {&end_, "end"}};
  if (plan.contact_term())
    wanted.emplace_back(&choose_, "choose");
  else
    wanted.emplace_back(&first_, "first");
  if (plan.self_collision) wanted.emplace_back(&contacts_, "contacts");
  if (plan.wind) wanted.emplace_back(&wind_, "wind");
  for (const auto& [program, name] : wanted)
    if (const Status loaded = load_own(*program, name, defines); !loaded) return loaded;
  if (plan.contact_term()) advance_.set("solved", 1);
  if (plan.wind) {
    wind_loads_ = {gl::Buffer(std::size_t{model.vertex_count()} * 4 * sizeof(float)), GL_RGBA32F};
    if (bdf2_)
      for (gl::TextureBuffer* vector : {&expected_position_, &expected_velocity_})
        *vector = {gl::Buffer(wind_loads_.buffer.bytes()), GL_RGBA32F};
  }
  return solver_.load(defines);
}

void ImplicitPasses::set_parameters(const Surroundings& around) {
  for (const gl::Program* program : programs()) {
    set_step_uniforms(*program, around);
    program->set("step_length", static_cast<float>(around.scene.solver.dt));
  }
  if (around.scene.solver.dt != dt_) restart();  // impulses kept in `contact_friction_` are forces times dt
  dt_ = around.scene.solver.dt;
  if (bdf2_) bdf2_->set_parameters(around);
  solver_.set_parameters(around);
}

void ImplicitPasses::run(const gl::Program& program) {
  program.use();
  dispatch(groups_);
  wait_for_writes();
}

void ImplicitPasses::begin(StateBuffers& state, int row) {
  state.bind_for_step();
  bind_inputs(state);
  if (wind_.id()) {
    if (bdf2_ && bdf2_->by_formula()) expect();
    wind_loads_.buffer.bind_storage(slot_wind);
    wind_.set("start_row", row);
    run(wind_);
    state.bind_for_step();
  }
  if (bdf2_) bdf2_->bind_begin(start_);
  start_position_.buffer.bind_storage(slot_start_position);
  bind_estimate();
  if (contact_) first_change_.buffer.bind_storage(slot_first_change);
  start_.set("start_row", row);
  run(start_);
}

void ImplicitPasses::begin_with_velocity() {
  start_position_.bind(unit_position);
  still_.bind(unit_velocity);
  velocity_.bind(unit_change);
  solver_.sums().buffer.bind_storage(slot_group_sums);
  run(search_);
  position_.buffer.bind_storage(slot_next_position);
  bind_estimate();
  run(first_);
}

void ImplicitPasses::expect() {
  bdf2_->expect(expected_position_, expected_velocity_);
  expected_position_.bind(unit_position);
  expected_velocity_.bind(unit_velocity);
}

void ImplicitPasses::bind_inputs(const StateBuffers& state) {
  state.position().bind(unit_before_position);
  state.velocity().bind(unit_before_velocity);
  start_position_.bind(unit_start_position);
  start_velocity_.bind(unit_start_velocity);
  constraint_.bind(unit_constraint);
  surface_.bind(unit_surface);
  solver_.bind();
  block_a_.bind(unit_block_a);
  block_b_.bind(unit_block_b);
  if (wind_.id()) wind_loads_.bind(unit_wind);
}

void ImplicitPasses::bind_estimate() {
  start_velocity_.buffer.bind_storage(slot_start_velocity);
  velocity_.buffer.bind_storage(slot_estimate);
  guess_.buffer.bind_storage(slot_guess);
  constraint_.buffer.bind_storage(slot_constraint);
  surface_.buffer.bind_storage(slot_surface);
  contact_friction_.bind_storage(slot_grip);
}

void ImplicitPasses::set_up(bool first, bool exact) {
  position_.bind(unit_position);
  system_.set("first", first ? 1 : 0);
  system_.set("exact", contact_ && exact ? 1 : 0);
  velocity_.bind(unit_velocity);
  guess_.bind(unit_change);
  solver_.residual().buffer.bind_storage(slot_residual);
  block_a_.buffer.bind_storage(slot_block_a);
  block_b_.buffer.bind_storage(slot_block_b);
  trends_.buffer.bind_storage(slot_trends);
  past_velocities_.bind_storage(slot_past_velocities);
  run(system_);
}

void ImplicitPasses::improve_guess() {
  solver_.residual().bind(unit_residual);
  trends_.bind(unit_trends);
  trend_products_.buffer.bind_storage(slot_trend_products);
  solver_.sums().buffer.bind_storage(slot_group_sums);
  run(project_);
  trend_products_.bind(unit_trend_products);
  solver_.residual().buffer.bind_storage(slot_residual);
  guess_.buffer.bind_storage(slot_guess);
  run(improve_);
}

void ImplicitPasses::search(const gl::TextureBuffer& change) {
  change.bind(unit_change);
  solver_.sums().buffer.bind_storage(slot_group_sums);
  run(search_);
}

void ImplicitPasses::advance(int row, bool another) {
  position_.buffer.bind_storage(slot_next_position);
  bind_estimate();
  advance_.set("start_row", row);
  advance_.set("another", another ? 1 : 0);
  run(advance_);
}

void ImplicitPasses::keep_apart() {
  static_assert(contact_passes % 2 == 0);
  position_.buffer.bind_storage(slot_next_position);
  for (int pass = 0; pass < contact_passes; ++pass) {
    (pass % 2 == 0 ? velocity_ : guess_).bind(unit_velocity);
    (pass % 2 == 0 ? guess_ : velocity_).buffer.bind_storage(slot_estimate);
    run(contacts_);
  }
}

void ImplicitPasses::finish(StateBuffers& state, const gl::TextureBuffer& residual, int row) {
  position_.bind(unit_position);
  velocity_.bind(unit_velocity);
  residual.bind(unit_residual);
  contact_friction_.bind_storage(slot_grip);
  state.bind_outputs();
  end_.set("start_row", row);
  if (contact_) contact_->bind_end(end_);
  run(end_);
}

void ImplicitPasses::set_equation_time() {
  for (const gl::Program* program : programs()) program->set("dt", static_cast<float>(bdf2_->dt()));
  solver_.set_dt(bdf2_->dt());
  if (contact_) contact_->term()->set_dt(bdf2_->dt(), bdf2_->step_length());
}

std::vector<const gl::Program*> ImplicitPasses::programs() const {
  std::vector<const gl::Program*> loaded;
  for (const gl::Program* program : {&start_, &first_, &system_, &project_, &improve_, &search_, &choose_,
                                     &advance_, &end_, &contacts_, &wind_})
    if (program->id()) loaded.push_back(program);
  return loaded;
}

/// -1 is `untouched` in implicit_friction.glsl.
void ImplicitPasses::restart() {
  const std::vector<float> untouched(contact_friction_.bytes() / sizeof(float), -1.0F);
  contact_friction_.upload(untouched.data(), contact_friction_.bytes());
  past_velocities_.fill(0);
  if (bdf2_) bdf2_->restart();
}

void ImplicitPasses::carry(Carrier& carrier) {
  carrier.buffer(contact_friction_);
  carrier.buffer(past_velocities_);
  if (bdf2_) bdf2_->carry(carrier);
}

}  // namespace clothlab::sim
