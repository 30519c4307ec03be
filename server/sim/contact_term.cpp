#include "server/sim/contact_term.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <tuple>

#include "server/sim/colliders.h"
#include "server/sim/integrator.h"
#include "server/sim/surface_control.h"

namespace clothlab::sim {

namespace {

/// As shaders/surface/term.glsl has it.
struct Term {
  using List = std::array<std::uint32_t, 4>;
  static constexpr List none{0, 1, 1, 0};
  List kept = none, pressing = none, touched = none, reachable = none;
  std::uint32_t entries = 0;
  float share = 1.0f;
  float longest = 0.0f, pressed = 0.0f;
  float taken = 1.0f, pins = 1.0f;
  std::uint32_t meets = 0, unused = 0;
  std::array<std::uint32_t, 4> largest{};
  std::array<std::int32_t, 4> high{};
  std::array<std::uint32_t, 4> low{};
  std::array<std::uint32_t, 4> rubs{};
};
constexpr std::size_t texels_of_pair = 6;  // term.glsl: pair_texels
constexpr std::uint32_t first_capacity = 4096;
/// As many as their sums on the GPU have room for, and a texture buffer.
std::uint32_t most_pairs() {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return std::min(1u << 21, static_cast<std::uint32_t>(texels / static_cast<GLint>(texels_of_pair)));
}
constexpr std::size_t bytes_of_pair =
    16 * texels_of_pair + 16 + 4 * 8 + 2 * 4 * 4;  // as `make_lists` makes them

/// So many layers that lie on each other are to be within a twentieth of the thickness of it.
constexpr double layers = 10.0;
/// Slower than this is no sliding [m/s]: what lies still creeps by less.
constexpr float still_speed = 2e-4f;

/// Runs a program over a list: its groups are at this place of the bound buffer.
void run(const gl::Program& program, std::size_t groups) {
  program.use();
  glDispatchComputeIndirect(static_cast<GLintptr>(groups));
  wait_for_writes();
}

/// Runs a program over so many vertices.
void run_each(const gl::Program& program, std::uint32_t vertices) {
  program.use();
  glDispatchCompute(vertex_groups(vertices), 1, 1);
  wait_for_writes();
}

}  // namespace

Result<ContactTerm> ContactTerm::create(const model::Model& model, const Plan& plan,
                                        std::uint32_t vertex_count) {
  ContactTerm made;
  made.vertex_count_ = vertex_count;
  made.cloth_vertex_count_ = model.vertex_count();
  made.solids_ = plan.solid_count() > 0;
  const auto with = [&](const char* name, const char* value) {
    gl::Defines defines = step_defines(plan);
    if (plan.method == scene::Method::bdf2) defines.emplace_back("BDF2", "1");
    if (*name) defines.emplace_back(name, value);
    return defines;
  };
  for (const auto& [program, name, defines] : {std::tuple{&made.cull_, "cull", with("ALONG_WAY", "0")},
                                               {&made.cull_way_, "cull", with("ALONG_WAY", "1")},
                                               {&made.pairs_, "pairs", with("", "")},
                                               {&made.ranks_program_, "ranks", with("", "")},
                                               {&made.lists_, "lists", with("", "")},
                                               {&made.way_program_, "way", with("", "")},
                                               {&made.limit_, "limit", with("OF_PINS", "0")},
                                               {&made.limit_pins_, "limit", with("OF_PINS", "1")},
                                               {&made.hold_, "hold", with("", "")},
                                               {&made.energy_, "energy", with("", "")},
                                               {&made.friction_, "friction", with("", "")},
                                               {&made.sum_, "sum", with("OF_FRICTION", "0")},
                                               {&made.sum_friction_, "sum", with("OF_FRICTION", "1")},
                                               {&made.bodies_, "bodies", with("", "")},
                                               {&made.press_solids_, "solids", with("", "")},
                                               {&made.limit_solids_, "limit_solids", with("", "")}}) {
    if (!made.solids_ && (program == &made.press_solids_ || program == &made.limit_solids_)) continue;
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/term_") + name + ".comp"}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("vertex_count", static_cast<GLint>(vertex_count));
    program->set("cloth_vertex_count", static_cast<GLint>(made.cloth_vertex_count_));
    program->set("still_speed", still_speed);
  }
  const auto vectors = [&] {
    return gl::TextureBuffer(gl::Buffer(std::size_t{vertex_count} * 4 * sizeof(float)), GL_RGBA32F);
  };
  for (gl::TextureBuffer* of_each : {&made.ends_, &made.way_, &made.target_, &made.velocity_})
    *of_each = vectors();
  made.vertices_ = {gl::Buffer(std::size_t{vertex_count} * 2 * sizeof(std::uint32_t)), GL_RG32UI};
  made.vertices_.buffer.fill(0);
  made.touched_ = {gl::Buffer(std::size_t{vertex_count} * sizeof(std::uint32_t)), GL_R32UI};
  made.control_ = gl::Buffer(sizeof(Term));
  made.most_ = most_pairs();
  made.begun_ = first_capacity;
  made.make_lists(first_capacity);
  made.pins_wait_ = plan.pins && plan.moving > 0;
  return made;
}

void ContactTerm::make_lists(std::uint32_t capacity) {
  capacity_ = capacity;
  term_pairs_ = {gl::Buffer(texels_of_pair * capacity * 4 * sizeof(std::uint32_t)), GL_RGBA32UI};
  links_ = {gl::Buffer(std::size_t{capacity} * 4 * 2 * sizeof(std::uint32_t)), GL_RG32UI};
  friction_energies_ = {gl::Buffer(std::size_t{capacity} * 4 * sizeof(float)), GL_RGBA32F};
  ranks_ = {gl::Buffer(std::size_t{capacity} * 4 * sizeof(std::uint32_t)), GL_R32UI};
  entries_ = {gl::Buffer(std::size_t{capacity} * 4 * sizeof(std::uint32_t)), GL_R32UI};
  for (const gl::Program* program : programs())
    glProgramUniform1ui(program->id(), program->location("term_capacity"), capacity);
}

std::vector<const gl::Program*> ContactTerm::programs() const {
  std::vector<const gl::Program*> loaded;
  for (const gl::Program* program :
       {&cull_, &cull_way_, &pairs_, &ranks_program_, &lists_, &way_program_, &limit_, &limit_pins_, &hold_,
        &energy_, &friction_, &sum_, &sum_friction_, &bodies_, &press_solids_, &limit_solids_})
    if (program->id()) loaded.push_back(program);
  return loaded;
}

void ContactTerm::set_dt(double dt, double step_length) {
  dt_ = static_cast<float>(dt);
  for (const gl::Program* program : programs()) {
    program->set("dt", dt_);
    program->set("step_length", static_cast<float>(step_length));
  }
}

void ContactTerm::set_parameters(const scene::Scene& scene, const model::Model& model,
                                 const MotionTable& motions) {
  dt_ = static_cast<float>(scene.solver.dt);
  const double thickness = SurfacePairs::thickness(scene, model);
  const double pull = std::max(glm::length(scene.gravity), gravity_at_least);
  const double margin = least_contact_margin(scene, model);
  margin_ = static_cast<float>(margin);
  solid_stiffness_ = static_cast<float>(20.0 * layers * pull / margin);
  heaviest_ = static_cast<float>(*std::max_element(model.mass.begin(), model.mass.end()));
  for (const gl::Program* program : programs()) {
    set_colliders(*program, scene, model, motions);
    program->set("dt", dt_);
    program->set("thickness", static_cast<float>(thickness));
    program->set("least_query", static_cast<float>(SurfacePairs::least_query(scene, model)));
    program->set("stiffness_per_mass", static_cast<float>(20.0 * layers * pull / thickness));
    program->set("friction", static_cast<float>(scene.self_collision ? scene.self_collision->friction : 0.0));
  }
}

void ContactTerm::set_solids(const gl::Program& program) const {
  program.set("margin", margin_);
  program.set("solid_stiffness_per_mass", solid_stiffness_);
  program.set("heaviest", heaviest_);
  program.set("gone", gone_);
  program.set("start_row", row_);
}

void ContactTerm::set_limits(const SurfacePairs& pairs) const {
  for (const gl::Program* program :
       {&cull_, &cull_way_, &pairs_, &limit_, &limit_pins_, &energy_, &friction_, &sum_, &sum_friction_})
    pairs.set_limits(*program);
}

void ContactTerm::begin(const StateBuffers& state, const SurfaceBodies& bodies, int row) {
  step_start_ = &state.position();
  step_velocity_ = &state.velocity();
  gone_ = 0;
  row_ = row;
  bodies_move_ = bodies.moves();
  if (bodies_move_) bodies.place_end(ends_.buffer, velocity_.buffer, row);
  for (const gl::Program* program : {&pairs_, &way_program_})
    program->set("bodies_move", bodies_move_ ? 1 : 0);
}

std::uint32_t ContactTerm::find(const SurfacePairs& pairs, const gl::TextureBuffer& position, bool first) {
  vertices_.buffer.fill(0);
  pressing_ = 0;
  incomplete_ = false;
  const bool any_pairs = !pairs.none(offsetof(SurfaceControl, pair_groups));
  if (!any_pairs && !solids_) return 0;
  pairs.bind();
  set_limits(pairs);
  for (;;) {
    const Term nothing;
    control_.upload(&nothing, sizeof nothing);
    control_.bind_storage(slot_term_control);
    position.bind(unit_position);
    pairs.bind_term();
    if (any_pairs) run(cull_, offsetof(SurfaceControl, pair_groups));
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
    step_start_->bind(unit_step_start);
    step_velocity_->bind(unit_step_velocity);
    for (const gl::Program* program : {&pairs_, &press_solids_, &friction_})
      if (program->id()) program->set("first", first ? 1 : 0);
    for (const gl::Program* program : {&pairs_, &press_solids_})
      if (program->id()) program->set("last_share", first ? 0.0f : last_share_);
    way_.bind(unit_term_way);
    ends_.bind(unit_term_ends);
    term_pairs_.buffer.bind_storage(slot_term_pairs);
    vertices_.buffer.bind_storage(slot_term_vertices);
    links_.buffer.bind_storage(slot_term_links);
    touched_.buffer.bind_storage(slot_term_touched);
    if (any_pairs) run(pairs_, offsetof(Term, kept));
    if (solids_) {
      step_start_->bind(unit_term_start);
      set_solids(press_solids_);
      press_solids_.set("last_gone", last_gone_);
      run_each(press_solids_, cloth_vertex_count_);
    }
    term_pairs_.bind(unit_term_pairs);
    links_.bind(unit_term_links);
    touched_.bind(unit_term_touched);
    vertices_.bind(unit_term_vertices);
    ranks_.buffer.bind_storage(slot_term_ranks);
    run(ranks_program_, offsetof(Term, pressing));
    ranks_.bind(unit_term_ranks);
    entries_.buffer.bind_storage(slot_term_entries);
    run(lists_, offsetof(Term, touched));
    Term::List pressing;
    control_.download(&pressing, sizeof pressing, offsetof(Term, pressing));
    pressing_ = pressing[3];
    if (pressing_ <= capacity_) return pressing_;
    vertices_.buffer.fill(0);
    const std::uint32_t wanted = std::max(pressing_, std::min(2 * pressing_, most_));
    if (!may_have(wanted)) {
      incomplete_ = true;
      return pressing_ = 0;
    }
    make_lists(wanted);
    pairs.bind();
  }
}

/// Reserves what lists of this length take beyond those of the beginning.
bool ContactTerm::may_have(std::uint32_t capacity) {
  const std::size_t bytes = bytes_of_pair * (capacity - std::min(capacity, begun_));
  return capacity <= most_ && (!memory_ || memory_->resize(grown_, bytes));
}

void ContactTerm::shorten_lists(std::uint32_t entries, bool for_good) {
  most_ = for_good ? entries : most_pairs();
  begun_ = entries;
  make_lists(entries);
}

std::vector<PressingPair> ContactTerm::read() const {
  std::vector<std::array<std::uint32_t, 4 * texels_of_pair>> words(pressing_);
  if (pressing_ > 0) term_pairs_.buffer.download(words.data(), words.size() * sizeof words[0]);
  std::sort(words.begin(), words.end());  // by their corners: the order on the GPU depends on that of threads
  std::vector<PressingPair> pairs;
  for (const auto& word : words) {
    const auto number = [&](std::size_t k) { return static_cast<double>(std::bit_cast<float>(word[k])); };
    PressingPair pair;
    for (std::size_t k = 0; k < 4; ++k) {
      pair.vertices[k] = word[k] & 0x7fffffffu;
      pair.weights[k] = number(8 + k);
    }
    const glm::dvec3 n(number(4), number(5), number(6));
    const double along = number(7), across = number(15);
    pair.stiffness = across * glm::dmat3(1.0) + (along - across) * glm::outerProduct(n, n);
    const glm::dvec3 slid(number(16), number(17), number(18));
    const double excess = number(23);
    if (excess > 0.0) pair.stiffness -= excess / glm::dot(slid, slid) * glm::outerProduct(slid, slid);
    pairs.push_back(pair);
  }
  return pairs;
}

void ContactTerm::bind() const {
  term_pairs_.bind(unit_term_pairs);
  vertices_.bind(unit_term_vertices);
  entries_.bind(unit_term_entries);
}

ContactTerm::Limit ContactTerm::limit(SurfacePairs& pairs, const gl::TextureBuffer& position,
                                      const gl::TextureBuffer& change) {
  {
    const Term fresh;  // but for the pairs that press
    const std::size_t from = offsetof(Term, reachable);
    control_.upload(reinterpret_cast<const std::byte*>(&fresh) + from, sizeof fresh - from, from);
  }
  control_.bind_storage(slot_term_control);
  position.bind(unit_position);
  change.bind(unit_change);
  ends_.bind(unit_term_ends);
  way_.buffer.bind_storage(slot_term_way);
  target_.buffer.bind_storage(slot_term_target);
  velocity_.buffer.bind_storage(slot_term_velocity);
  vertices_.bind(unit_term_vertices);
  run_each(way_program_, vertex_count_);
  Limit found;
  found.known = pairs.update_for(position, target_, velocity_, dt_);
  if (incomplete_) {
    pairs.leave_out();
    found.known = false;
  }
  set_limits(pairs);
  pairs.bind();
  pairs.bind_term();
  control_.bind_storage(slot_term_control);
  position.bind(unit_position);
  way_.bind(unit_term_way);
  if (!pairs.none(offsetof(SurfaceControl, pair_groups)))
    run(cull_way_, offsetof(SurfaceControl, pair_groups));
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  if (pins_wait_) {
    run(limit_pins_, offsetof(Term, reachable));
    way_.buffer.bind_storage(slot_term_way);
    run_each(hold_, cloth_vertex_count_);
  }
  run(limit_, offsetof(Term, reachable));
  if (solids_) {
    step_start_->bind(unit_term_start);
    set_solids(limit_solids_);
    run_each(limit_solids_, cloth_vertex_count_);
  }
  pairs.bind_energies();
  run(energy_, offsetof(Term, reachable));
  term_pairs_.bind(unit_term_pairs);
  friction_energies_.buffer.bind_storage(slot_term_energies);
  if (pressing_ > 0) run(friction_, offsetof(Term, pressing));
  run(sum_, offsetof(Term, reachable));
  friction_energies_.bind(unit_term_energies);
  if (pressing_ > 0) run(sum_friction_, offsetof(Term, pressing));
  if (!found.known) {
    const float none = 0.0f;
    control_.upload(&none, sizeof none, offsetof(Term, share));
  }
  Term control;
  control_.download(&control, sizeof control);
  found.reachable = control.reachable[3] + control.meets;
  found.longest = control.longest;
  found.pressed = control.pressed;
  const auto sum = [&](std::size_t at) { return 2048.0 * control.rubs[at] + control.rubs[at + 1]; };
  found.slips = sum(2) / std::max(sum(0), 1.0);
  return found;
}

float ContactTerm::take_share() {
  float share = 0.0f;
  control_.download(&share, sizeof share, offsetof(Term, taken));
  last_share_ = share;
  last_gone_ = (1.0f - gone_) * share;
  gone_ += last_gone_;
  return share;
}

void ContactTerm::take(const gl::TextureBuffer& position) const {
  if (!bodies_move_) return;
  control_.bind_storage(slot_term_control);
  position.bind(unit_position);
  way_.bind(unit_term_way);
  position.buffer.bind_storage(slot_next_position);
  run_each(bodies_, vertex_count_ - cloth_vertex_count_);
}

}  // namespace clothlab::sim
