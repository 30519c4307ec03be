#include "server/sim/surface_contact.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <tuple>

#include "server/model/motion.h"
#include "server/scene/method.h"
#include "server/scene/solid.h"
#include "server/sim/colliders.h"
#include "server/sim/integrator.h"
#include "server/sim/surface_control.h"

namespace clothlab::sim {

namespace {

/// Passes after a step, or each piece of one. Of pushes, which rub, too. Of friction alone: what the last
/// pushes move sideways nothing has rubbed yet, and in long steps sheets that lie on others would creep. Of
/// the filter: in each, a layer that moves ahead makes room for the one behind it.
struct Passes {
  int pushes, rubs, filter;
};
constexpr Passes of_short_step{2, 0, 3}, of_long_step{4, 4, 3};
/// The filter stops no body, and pins should not wait for what can move: pushes must get the cloth out of
/// their way, layer behind layer.
constexpr Passes of_short_driven_step{8, 0, 3}, of_long_driven_step{16, 1, 8};
/// A step longer than this [s] is gone in pieces where vertices are fast, in so many at most. The shorter a
/// piece, the fewer pairs are near enough to meet in it; but even one that is not needed costs a GPU its
/// dispatches.
constexpr double longest_whole_step = 0.001;
constexpr int most_pieces = 8;
/// How far a vertex goes in a piece where pins, bodies or colliders move, in thicknesses: pushes make room
/// for so much, layer behind layer. Where they are too fast for that in `most_pieces`, a step of any length
/// has more.
constexpr double driven_advance = 0.25;
constexpr int most_driven_pieces = 64;
/// The filter stops no body. Where one goes farther than the listed pairs allow in these, a step has more.
constexpr int most_body_pieces = 1024;
constexpr std::size_t words_of_vertex = 8;  // shaders/surface/vertex_contacts.glsl
/// Share of an overlap that a step mends, and the most that it does a second [1/s]: what is mended is no
/// velocity, but it moves what lies on it.
constexpr double mended_in_step = 0.05, mended_in_second = 5.0;

/// No pin, body or collider ever moves faster [m/s].
double fastest_driven(const scene::Scene& scene, const model::Model& model) {
  double fastest = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] != model::not_pinned)
      fastest =
          std::max(fastest, model::top_speed(model.motions[static_cast<std::size_t>(model.pin_motion[i])],
                                             model.rest_position[i]));
  for (std::uint32_t i = 0; i < model.body_vertex_count(); ++i)
    fastest = std::max(fastest,
                       model::top_speed(model.bodies[model.vertex_body[i]].motion, model.body_position[i]));
  for (const scene::Collider& collider : scene.colliders) {
    if (collider.shape.index() >= scene::solid_kinds) continue;
    const scene::Solid solid = scene::solid(collider.shape);
    const double reach = solid.radius + glm::length(solid.extent);
    for (int axis = 0; axis < 3; ++axis)  // around a line in space, one of these six points is farthest
      for (const double side : {-1.0, 1.0}) {
        model::dvec3 point = solid.point;
        point[axis] += side * std::sqrt(3.0) * reach;
        fastest = std::max(fastest, model::top_speed(collider.motion, point));
      }
  }
  return fastest;
}

gl::TextureBuffer vector_per_vertex(std::uint32_t vertex_count) {
  return {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
}

}  // namespace

const std::size_t SurfaceContact::bytes_of_counts = sizeof(SurfaceControl);

Result<SurfaceContact> SurfaceContact::create(const model::Model& model, const Plan& plan) {
  SurfaceContact made;
  const SurfaceTriangles surface = surface_triangles(model, SurfaceBlocks::most_blocks);
  made.keeps_start_ = plan.strain_limit();
  Result<SurfaceBodies> bodies = SurfaceBodies::create(model, plan, surface);
  if (!bodies) return bodies.error();
  made.bodies_ = std::move(*bodies);
  made.cloth_vertex_count_ = model.vertex_count();
  made.vertex_count_ = model.vertex_count() + made.bodies_.count();
  Result<SurfacePairs> pairs = SurfacePairs::create(model, surface);
  if (!pairs) return pairs.error();
  made.pairs_ = std::move(*pairs);
  made.driven_ = plan.moving > 0;
  made.pairs_.set_driven(made.driven_);
  const gl::Defines defines = step_defines(plan);
  const auto with = [&](const char* name, const char* value) {
    gl::Defines more = defines;
    more.emplace_back(name, value);
    return more;
  };
  for (const auto& [program, name, its_defines] : {std::tuple{&made.cull_, "cull", defines},
                                                   {&made.contacts_, "contacts", defines},
                                                   {&made.forces_, "forces", defines},
                                                   {&made.apply_, "apply", defines},
                                                   {&made.begin_, "begin", defines},
                                                   {&made.path_program_, "path", defines},
                                                   {&made.advance_, "advance", defines},
                                                   {&made.limit_first_, "limit", with("PASS", "0")},
                                                   {&made.limit_again_, "limit", with("PASS", "1")},
                                                   {&made.limit_stop_, "limit", with("PASS", "2")},
                                                   {&made.move_, "move", with("LAST", "0")},
                                                   {&made.move_last_, "move", with("LAST", "1")}}) {
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/") + name + ".comp"}, its_defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("vertex_count", static_cast<GLint>(made.vertex_count_));
    program->set("triangle_count", static_cast<GLint>(surface.triangles.size()));
    program->set("cloth_vertex_count", static_cast<GLint>(made.cloth_vertex_count_));
  }
  if (plan.contact_term()) {
    Result<ContactTerm> term = ContactTerm::create(model, plan, made.vertex_count_);
    if (!term) return term.error();
    made.term_ = std::move(*term);
  }
  made.target_ = vector_per_vertex(made.vertex_count_);
  made.start_ = vector_per_vertex(made.vertex_count_);
  made.start_velocity_ = vector_per_vertex(made.vertex_count_);
  made.path_ = vector_per_vertex(made.vertex_count_);
  made.vertex_contacts_ = {gl::Buffer(made.vertex_count_ * words_of_vertex * sizeof(std::uint32_t)),
                           GL_RGBA32UI};
  made.borne_ = gl::Buffer(made.vertex_count_ * 8 * sizeof(float));
  const std::size_t limits = made.vertex_count_ + 2 * static_cast<std::size_t>(plan.moving);
  made.limits_ = {gl::Buffer(limits * sizeof(std::uint32_t)), GL_R32UI};
  return made;
}

std::array<const gl::Program*, 12> SurfaceContact::programs() const {
  return {&cull_,    &contacts_,    &forces_,      &apply_,      &begin_, &path_program_,
          &advance_, &limit_first_, &limit_again_, &limit_stop_, &move_,  &move_last_};
}

void SurfaceContact::set_parameters(const scene::Scene& scene, const model::Model& model,
                                    const MotionTable& motions) {
  const double dt = scene.solver.dt;
  const double advance = driven_ ? driven_advance * SurfacePairs::thickness(scene, model) : 1e30;
  const double driven_pieces = driven_ ? std::ceil(dt * fastest_driven(scene, model) / advance) : 1.0;
  pieces_ = std::max(dt > longest_whole_step ? most_pieces : 1,
                     static_cast<int>(std::min<double>(driven_pieces, most_driven_pieces)));
  if (term_) pieces_ = 1;
  pairs_.set_parameters(scene, model, pieces_, term_.has_value());
  advance_.set("most_advance", static_cast<float>(advance));
  for (const gl::Program* program : programs()) {
    program->set("dt", static_cast<float>(dt));
    program->set("piece_count", pieces_);
    program->set("thickness", static_cast<float>(SurfacePairs::thickness(scene, model)));
  }
  long_steps_ = scene::iterates(scene.solver.method);
  const Passes passes = driven_       ? long_steps_ ? of_long_driven_step : of_short_driven_step
                        : long_steps_ ? of_long_step
                                      : of_short_step;
  push_passes_ = term_ ? 0 : passes.pushes;
  rub_passes_ = term_ ? 0 : passes.rubs;
  filter_passes_ = passes.filter;
  for (const gl::Program* program : {&move_, &move_last_})
    program->set("margin", static_cast<float>(least_contact_margin(scene, model)));
  set_numbers(scene, model, motions);
  forces_.set("mend", static_cast<float>(std::min(mended_in_step, mended_in_second * dt)));
  invalidate();
}

void SurfaceContact::set_numbers(const scene::Scene& scene, const model::Model& model,
                                 const MotionTable& motions) {
  bodies_.set_parameters(scene, model, motions);
  if (term_) term_->set_parameters(scene, model, motions);
  for (const gl::Program* program : {&apply_, &advance_, &move_, &move_last_})
    set_colliders(*program, scene, model, motions);
  forces_.set("friction", static_cast<float>(scene.self_collision ? scene.self_collision->friction : 0.0));
}

void SurfaceContact::invalidate() {
  bodies_.invalidate();
  pairs_.invalidate();
  vertex_contacts_.buffer.fill(0);
  limits_.buffer.fill(std::bit_cast<std::uint32_t>(1.0f));
  turn_ = 0;
  updated_ = false;
}

void SurfaceContact::carry(Carrier& carrier) {
  pairs_.carry(carrier);
  carrier.buffer(vertex_contacts_.buffer);
  carrier.buffer(limits_.buffer);
  carrier.number(turn_);
  carrier.number(updated_);
  if (carrier.loads()) bodies_.invalidate();  // whose places are behind a state's that is put back
}

Work SurfaceContact::update_pairs(const StateBuffers& state, int row) {
  bodies_.place_at_start(state, row);
  bodies_.bind();
  if (!updated_) co_await pairs_.update(state);
  updated_ = true;
  if (!keeps_start_ && pieces_ == 1) co_return;
  start_.buffer.copy_from(state.position().buffer);
  start_velocity_.buffer.copy_from(state.velocity().buffer);
}

bool SurfaceContact::advance(const StateBuffers& state, int row, int piece, std::uint32_t changing) {
  const auto run = [&](const gl::Program& program) {
    program.use();
    program.set("changing_vertex_count", static_cast<GLint>(changing));
    glDispatchCompute(vertex_groups(changing), 1, 1);
    wait_for_writes();
  };
  bool room = true;
  state.position().bind(unit_position);
  state.velocity().bind(unit_velocity);
  state.position().buffer.bind_storage(slot_next_position);
  state.velocity().buffer.bind_storage(slot_next_velocity);
  pairs_.bind();
  if (piece == 0) {
    start_.bind(unit_step_start);
    path_.buffer.bind_storage(slot_path);
    run(path_program_);
  } else {
    room = pairs_.update_within_step(state);
    pairs_.bind();
  }
  path_.bind(unit_path);
  start_.buffer.bind_storage(slot_step_start);
  advance_.set("piece", std::min(piece, pieces_ - 1));
  if (driven_) advance_.set("start_row", row);
  run(advance_);
  return room;
}

void SurfaceContact::keep_apart(StateBuffers& state, int row) {
  const std::uint32_t changing = bodies_.changes() ? vertex_count_ : cloth_vertex_count_;
  bodies_.place_at_end(state, row);
  const int most = pieces_ > 1 && bodies_.changes() ? most_body_pieces : pieces_;
  for (int piece = 0; piece < most; ++piece) {
    const bool room = pieces_ == 1 || advance(state, row, piece, changing);
    const bool last = piece == most - 1 || !room;
    push_and_filter(state, row, changing, last);
    // Whether all of the step is gone. A GPU is waited for only where more pieces than expected may follow.
    const std::size_t left = offsetof(SurfaceControl, check);
    if (last || (piece < pieces_ - 1 ? pairs_.none(left) : pairs_.none_for_sure(left))) break;
  }
}

void SurfaceContact::push_and_filter(StateBuffers& state, int row, std::uint32_t changing, bool last_piece) {
  for (const gl::Program* program : {&contacts_, &begin_, &move_, &move_last_})
    program->set("changing_vertex_count", static_cast<GLint>(changing));
  const std::size_t counts =
      offsetof(SurfaceControl, step_counts) + static_cast<std::size_t>(turn_) * sizeof(StepCounts);
  const auto run = [&](const gl::Program& program, std::size_t groups) {
    program.use();
    program.set("turn", turn_);
    glDispatchComputeIndirect(static_cast<GLintptr>(groups));
    wait_for_writes();
  };
  const std::size_t near = counts + offsetof(StepCounts, near_groups),
                    vertices = counts + offsetof(StepCounts, vertex_groups),
                    touching = counts + offsetof(StepCounts, touching_groups),
                    pushed = counts + offsetof(StepCounts, pushed_groups),
                    meeting = counts + offsetof(StepCounts, meeting_groups),
                    cut_vertices = counts + offsetof(StepCounts, cut_vertices);
  pairs_.bind();
  bodies_.bind();
  for (const gl::Program* program : {&cull_, &contacts_, &begin_, &limit_first_, &limit_again_, &limit_stop_})
    pairs_.set_limits(*program);
  state.position().bind(unit_position);
  state.velocity().bind(unit_velocity);
  (keeps_start_ || term_ || pieces_ > 1 ? start_ : state.previous_position()).bind(unit_step_start);
  target_.bind(unit_step_target);
  state.position().buffer.bind_storage(slot_next_position);
  state.velocity().buffer.bind_storage(slot_next_velocity);
  vertex_contacts_.buffer.bind_storage(slot_vertex_contacts);
  vertex_contacts_.bind(unit_vertex_contacts);
  pairs_.bind_contacts();

  run(cull_, pieces_ > 1 ? offsetof(SurfaceControl, contact_groups) : offsetof(SurfaceControl, pair_groups));
  run(contacts_, counts + offsetof(StepCounts, kept_groups));
  if (driven_)
    for (const gl::Program* program : {&apply_, &move_last_}) program->set("start_row", row);
  pairs_.bind_pushes();
  borne_.bind_storage(slot_borne);
  const int passes = pairs_.none(touching) ? 0 : push_passes_ + rub_passes_;
  for (int pass = 0; pass < passes; ++pass) {
    const bool rubs = pass >= push_passes_;
    const int next_rubs = rub_passes_ > 0 && pass >= push_passes_ - 1 ? 1 : 0;
    forces_.set("first_pass", pass == 0 ? 1 : 0);
    forces_.set("pushes", rubs ? 0 : 1);
    forces_.set("rubs", rubs || rub_passes_ < push_passes_ ? 1 : 0);
    forces_.set("next_rubs", next_rubs);
    run(forces_, touching);
    apply_.set("recount", long_steps_ && pass > 0 ? 1 : 0);
    apply_.set("solid_friction", rub_passes_ == 0 ? 0 : rubs ? 3 : pass > 0 ? 2 : 1);
    run(apply_, pushed);
  }
  pairs_.bind();
  (keeps_start_ || pieces_ > 1 ? start_velocity_ : state.previous_velocity()).bind(unit_step_velocity);
  limits_.bind(unit_step_limits);
  limits_.buffer.bind_storage(slot_step_limits);
  target_.buffer.bind_storage(slot_step_target);
  begin_.use();
  begin_.set("turn", turn_);
  begin_.set("last_piece", last_piece ? 1 : 0);
  glDispatchCompute(vertex_groups(changing), 1, 1);
  wait_for_writes();
  const int filter_passes = pairs_.none(near) ? 0 : filter_passes_;
  for (int pass = 0; pass < filter_passes; ++pass) {
    const bool last = pass == filter_passes - 1;
    // What moves by itself spreads its step over all passes but the last one, lest it comes upon layers that
    // are yet to make room.
    const float held_part = last ? 1.0f : 1.0f / static_cast<float>(filter_passes - 1 - pass);
    const gl::Program& limit = pass == 0 ? limit_first_ : limit_again_;
    const gl::Program& move = last ? move_last_ : move_;
    const auto run_pass = [&](const gl::Program& program, std::size_t groups) {
      program.set("held_part", held_part);
      program.set("pass", pass);
      run(program, groups);
    };
    run_pass(limit, pass == 0 ? near : meeting);
    if (last) run_pass(limit_stop_, meeting);
    run_pass(move, pass == 0 || driven_ ? vertices : cut_vertices);
  }
  turn_ = 1 - turn_;
}

void SurfaceContact::copy_counts(const gl::Buffer& target, std::size_t offset) const {
  glCopyNamedBufferSubData(pairs_.control().id(), target.id(), 0, static_cast<GLintptr>(offset),
                           sizeof(SurfaceControl));
}

SurfaceContact::Counters SurfaceContact::read_counts(const std::byte* counts) {
  SurfaceControl control;
  std::memcpy(&control, counts, sizeof control);
  return {control.pairs,     std::max(control.step_counts[0].near, control.step_counts[1].near),
          control.cuts,      control.forced,
          control.not_taken, control.rebuilds};
}

}  // namespace clothlab::sim
