#include "server/sim/surface_pairs.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>

#include "server/base/pieces.h"
#include "server/gl/context.h"
#include "server/sim/integrator.h"
#include "server/sim/surface_control.h"

namespace clothlab::sim {

namespace {

constexpr std::uint64_t updates_between_size_looks = 8;
constexpr std::uint32_t most_listed = 1u << 21;

/// How many entries a list may have on this device.
std::uint32_t most_entries() {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return std::min(most_listed, static_cast<std::uint32_t>(texels) / 4);
}

}  // namespace

Result<SurfacePairs> SurfacePairs::create(const model::Model& model, const SurfaceTriangles& surface) {
  SurfacePairs made;
  made.answers_ = gl::AnswersAtOnce::of_device();
  made.vertex_count_ = model.vertex_count() + static_cast<std::uint32_t>(surface.body_places.size());
  made.triangle_count_ = static_cast<std::uint32_t>(surface.triangles.size());
  const gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                            {"LEAF_SIZE", std::to_string(leaf_size)},
                            {"BUNDLE_SIZE", std::to_string(bundle_size)},
                            {"BOUGH_SIZE", std::to_string(bough_size)},
                            {"OUT_OF_PLANE", std::to_string(out_of_plane)}};
  for (auto [program, name] : {std::pair{&made.triangle_boxes_program_, "triangle_boxes"},
                               {&made.boxes_program_, "boxes"},
                               {&made.leaf_pairs_program_, "leaf_pairs"},
                               {&made.bundle_pairs_program_, "bundle_pairs"},
                               {&made.triangle_pairs_program_, "triangle_pairs"},
                               {&made.neighbours_, "neighbours"},
                               {&made.candidates_, "candidates"},
                               {&made.pairs_program_, "pairs"},
                               {&made.rest_, "rest"},
                               {&made.finish_, "finish"}}) {
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/") + name + ".comp"}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("vertex_count", static_cast<GLint>(made.vertex_count_));
    program->set("triangle_count", static_cast<GLint>(made.triangle_count_));
    program->set("cloth_vertex_count", static_cast<GLint>(model.vertex_count()));
    program->set("cloth_triangle_count", static_cast<GLint>(surface.cloth_triangle_count));
    program->set("neighbour_pair_count", static_cast<GLint>(surface.neighbour_pairs.size()));
  }
  Result<SurfaceBlocks> blocks = SurfaceBlocks::create(surface, made.vertex_count_);
  if (!blocks) return blocks.error();
  made.blocks_ = std::move(*blocks);
  made.control_ = gl::Buffer(sizeof(SurfaceControl));
  made.sizes_ring_ = gl::ReadbackRing(sizeof(SurfaceControl), 1);
  const std::uint32_t leaves = (made.triangle_count_ + leaf_size - 1) / leaf_size;
  made.triangles_ = {gl::Buffer(surface.triangles), GL_RGBA32UI};
  made.rest_places_ = {gl::Buffer(surface.rest_places), GL_RGBA32F};
  made.neighbour_pairs_ = {gl::Buffer(surface.neighbour_pairs), GL_RGBA32UI};
  made.triangle_boxes_ = {gl::Buffer(made.triangle_count_ * 16 * sizeof(std::uint32_t)), GL_RGBA32UI};
  const std::uint32_t bundles = (made.triangle_count_ + bundle_size - 1) / bundle_size;
  const std::uint32_t boughs = (leaves + bough_size - 1) / bough_size;
  made.boxes_ = {gl::Buffer((leaves + bundles + boughs) * 16 * sizeof(float)), GL_RGBA32F};
  made.expected_ = {gl::Buffer(made.vertex_count_ * 8 * sizeof(float)), GL_RGBA32F};
  made.most_ = most_entries();
  constexpr std::uint32_t generous = 1u << 17;  // entries: little memory, and lists seldom have to grow
  made.make_lists({8 * leaves + 256, 8 * bundles + 1024,
                   std::min(8 * made.triangle_count_, 2 * made.triangle_count_ + generous),
                   std::min(32 * made.vertex_count_, 8 * made.vertex_count_ + generous)});
  made.memory_ = ListMemory::of_thread();
  made.begun_bytes_ = bytes_of(made.capacity_);
  const SurfaceControl nothing;
  made.control_.upload(&nothing, sizeof nothing);
  return made;
}

void SurfacePairs::make_lists(const Capacities& wanted) {
  capacity_ = {std::min(wanted.leaf_pairs, most_), std::min(wanted.bundle_pairs, most_),
               std::min(wanted.triangle_pairs, most_), std::min(wanted.pairs, most_)};
  const auto pairs_of_numbers = [](std::uint32_t count) {
    return gl::TextureBuffer(gl::Buffer(std::size_t{count} * 2 * sizeof(std::uint32_t)), GL_RG32UI);
  };
  leaf_pairs_ = pairs_of_numbers(capacity_.leaf_pairs);
  bundle_pairs_ = pairs_of_numbers(capacity_.bundle_pairs);
  triangle_pairs_ = pairs_of_numbers(capacity_.triangle_pairs);
  pairs_ = {gl::Buffer(std::size_t{capacity_.pairs} * 4 * sizeof(std::uint32_t)), GL_RGBA32UI};
  near_pairs_ = {gl::Buffer(std::size_t{capacity_.pairs} * 12 * sizeof(std::uint32_t)), GL_RGBA32UI};
  chosen_pairs_ = {gl::Buffer(std::size_t{capacity_.pairs} * 2 * sizeof(std::uint32_t)), GL_R32UI};
  pair_loads_ = {gl::Buffer(std::size_t{capacity_.pairs} * 4 * sizeof(float)), GL_RGBA32F};
  contact_links_ = pairs_of_numbers(4 * capacity_.pairs);
  contact_pushes_ = {gl::Buffer(std::size_t{capacity_.pairs} * 8 * sizeof(float)), GL_RGBA32F};
  for (const gl::Program* program : programs()) {
    glProgramUniform1ui(program->id(), program->location("leaf_pair_capacity"), capacity_.leaf_pairs);
    glProgramUniform1ui(program->id(), program->location("bundle_pair_capacity"), capacity_.bundle_pairs);
    glProgramUniform1ui(program->id(), program->location("triangle_pair_capacity"), capacity_.triangle_pairs);
    glProgramUniform1ui(program->id(), program->location("pair_capacity"), capacity_.pairs);
  }
}

std::size_t SurfacePairs::bytes_of(const Capacities& capacities) {
  constexpr std::size_t pair_of_numbers = 8;
  constexpr std::size_t pair = 16 + 48 + 8 + 16 + 4 * pair_of_numbers + 32;  // as `make_lists` makes them
  return pair_of_numbers *
             (std::size_t{capacities.leaf_pairs} + capacities.bundle_pairs + capacities.triangle_pairs) +
         pair * capacities.pairs;
}

/// Reserves what lists of these sizes take beyond those of the beginning.
bool SurfacePairs::may_have(const Capacities& wanted) {
  const std::size_t bytes = bytes_of(wanted);
  return !memory_ || memory_->resize(grown_, bytes - std::min(bytes, begun_bytes_));
}

std::array<const gl::Program*, 10> SurfacePairs::programs() const {
  return {&triangle_boxes_program_,
          &boxes_program_,
          &leaf_pairs_program_,
          &bundle_pairs_program_,
          &triangle_pairs_program_,
          &neighbours_,
          &candidates_,
          &pairs_program_,
          &rest_,
          &finish_};
}

double SurfacePairs::least_query(const scene::Scene& scene, const model::Model& model) {
  return std::min(1.2 * thickness(scene, model), 0.25 * finest_edge(model));
}

double SurfacePairs::finest_edge(const model::Model& model) {
  double edge = 0.0;
  for (const model::ClothRange& cloth : model.cloths)
    edge = edge > 0.0 ? std::min(edge, cloth.mean_edge_length) : cloth.mean_edge_length;
  return edge;
}

double SurfacePairs::thickness(const scene::Scene& scene, const model::Model& model) {
  if (scene.collides(scene::ContactKind::surface)) return scene.self_collision->thickness;
  return std::min(0.1 * finest_edge(model), 0.005);
}

void SurfacePairs::set_parameters(const scene::Scene& scene, const model::Model& model, int pieces,
                                  bool asks_ahead) {
  const double thickness = SurfacePairs::thickness(scene, model), edge = finest_edge(model);
  in_pieces_ = pieces > 1 || asks_ahead;
  constexpr int no_motion = 1 << 20;  // in so many pieces a step goes no way that a search could see
  // Parts of a flat grid that share no vertex are 0.7 of a cell's side apart, which is 0.6 of the mean edge.
  // A search that reaches less far for what is side by side, also where the cloth goes together somewhat,
  // lists little.
  const double skin = std::max(0.45 * edge - 1.2 * thickness, 0.2 * edge);
  const auto least = static_cast<float>(least_query(scene, model));
  blocks_.set_parameters(static_cast<float>(skin), static_cast<float>(scene.solver.dt));
  for (const gl::Program* program : programs()) {
    program->set("dt", static_cast<float>(scene.solver.dt));
    program->set("piece_count", asks_ahead ? no_motion : pieces);
    program->set("thickness", static_cast<float>(thickness));
    program->set("least_query", least);
    program->set("cloth_pairs", scene.collides(scene::ContactKind::surface) ? 1 : 0);
  }
  widest_query_ = static_cast<float>(24.0 * edge + 4.0 * thickness);
  narrowest_query_ = 0.25f * least;
  limit_query(widest_query_);
}

void SurfacePairs::limit_query(float most) {
  most_query_ = most;
  for (const gl::Program* program : programs()) program->set("most_query", most);
}

void SurfacePairs::invalidate() {
  forget_pairs();
  updates_ = 0;
}

void SurfacePairs::shorten_lists(std::uint32_t entries, bool for_good) {
  most_ = for_good ? entries : most_entries();
  make_lists({entries, entries, entries, entries});
  begun_bytes_ = bytes_of(capacity_);
  invalidate();
}

void SurfacePairs::forget_pairs(bool within_step) {
  SurfaceControl before, control;
  control_.download(&before, sizeof before);
  control.rebuilds = before.rebuilds;
  control.cuts = before.cuts;
  control.forced = before.forced;
  control.not_taken = before.not_taken;
  // A search that is to list less reaches less far in all that makes it reach.
  const float narrower =
      std::min(most_query_ / std::max(std::bit_cast<float>(before.query), most_query_), 1.0f);
  control.next_skin = narrower * before.next_skin;
  control.next_ahead = narrower * before.next_ahead;
  if (within_step) {
    control.longest = before.longest;
    control.longest_of_bodies = before.longest_of_bodies;
    control.gone = before.gone;
    control.part = before.part;
  }
  control.rebuild[0] = vertex_groups(std::max(vertex_count_, triangle_count_));
  control_.upload(&control, sizeof control);
  searched_ = false;
}

void SurfacePairs::carry(Carrier& carrier) {
  SurfaceControl control;
  if (!carrier.loads()) control_.download(&control, sizeof control);
  Capacities capacity = capacity_;
  float most_query = most_query_;
  carrier.number(control);
  carrier.number(capacity);
  carrier.number(most_query);
  carrier.number(updates_);
  carrier.number(searched_);
  carrier.ring(sizes_ring_);
  if (carrier.loads() && carrier.fits()) {
    const bool fits = capacity == capacity_ || may_have(capacity);
    if (fits && capacity != capacity_) make_lists(capacity);
    limit_query(most_query);
    control_.upload(&control, sizeof control);
    if (!fits) forget_pairs();  // they are searched anew, with the lists that there are
  }
  carrier.buffer(expected_.buffer);
  const std::uint32_t pairs = searched_ ? std::min(control.pairs, capacity_.pairs) : 0;
  carrier.buffer(pairs_.buffer, std::size_t{pairs} * 4 * sizeof(std::uint32_t));
}

bool SurfacePairs::none(std::size_t groups) const {
  return answers_.none(control_, groups);
}

bool SurfacePairs::none_for_sure(std::size_t groups) const {
  std::uint32_t count = 1;
  control_.download(&count, sizeof count, groups);
  return count == 0;
}

bool SurfacePairs::search(const StateBuffers& state) {
  return search(state.position(), state.velocity());
}

bool SurfacePairs::search(const gl::TextureBuffer& position, const gl::TextureBuffer& velocity) {
  if (none(offsetof(SurfaceControl, rebuild))) return false;
  const auto dispatch = [](const gl::Program& program, std::size_t groups) {
    program.use();
    glDispatchComputeIndirect(static_cast<GLintptr>(groups));
    wait_for_writes();
    between_pieces();
  };
  position.bind(unit_position);
  velocity.bind(unit_velocity);
  triangles_.bind(unit_surface_triangles);
  rest_places_.bind(unit_rest_places);
  triangle_boxes_.bind(unit_triangle_boxes);
  boxes_.bind(unit_boxes);
  leaf_pairs_.bind(unit_leaf_pairs);
  neighbour_pairs_.bind(unit_neighbour_pairs);
  triangle_pairs_.bind(unit_triangle_pairs);
  control_.bind_storage(slot_surface_control);
  control_.bind_uniform(slot_known_control);
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  expected_.bind(unit_expected);
  triangle_boxes_.buffer.bind_storage(slot_triangle_boxes);
  expected_.buffer.bind_storage(slot_expected);
  dispatch(triangle_boxes_program_, offsetof(SurfaceControl, rebuild));
  boxes_.buffer.bind_storage(slot_boxes);
  dispatch(boxes_program_, offsetof(SurfaceControl, rebuild));
  leaf_pairs_.buffer.bind_storage(slot_leaf_pairs);
  dispatch(leaf_pairs_program_, offsetof(SurfaceControl, rebuild));
  bundle_pairs_.buffer.bind_storage(slot_bundle_pairs);
  dispatch(bundle_pairs_program_, offsetof(SurfaceControl, leaf_groups));
  bundle_pairs_.bind(
      unit_bundle_pairs);  // the unit was that of the triangles, which only their boxes are made of
  triangle_pairs_.buffer.bind_storage(slot_triangle_pairs);
  dispatch(triangle_pairs_program_, offsetof(SurfaceControl, bundle_groups));
  near_pairs_.buffer.bind_storage(slot_near_pairs);
  near_pairs_.bind(unit_near_pairs);
  dispatch(neighbours_, offsetof(SurfaceControl, neighbour_groups));
  dispatch(candidates_, offsetof(SurfaceControl, split));
  pairs_.buffer.bind_storage(slot_surface_pairs);
  dispatch(pairs_program_, offsetof(SurfaceControl, candidate_groups));
  dispatch(rest_, offsetof(SurfaceControl, rest));
  dispatch(finish_, offsetof(SurfaceControl, finish));
  searched_ = true;
  return true;
}

Work SurfacePairs::update(const StateBuffers& state) {
  wait_for_writes();
  bind();
  blocks_.check(state.position(), expected_);
  const bool searched = search(state);
  bool look = updates_++ % updates_between_size_looks == 0 || waits();
  if (searched && answers_) look = look || !none(offsetof(SurfaceControl, overflow));
  while (look && make_room(false)) {
    co_await may_stop;
    search(state);
  }
}

bool SurfacePairs::update_within_step(const StateBuffers& state) {
  blocks_.check_again(state.position(), expected_, offsetof(SurfaceControl, check));
  const bool searched = search(state);
  const bool look = driven_ || (searched && answers_ && !none(offsetof(SurfaceControl, overflow)));
  while (look && make_room(true)) search(state);
  return !no_room_;
}

bool SurfacePairs::update_for(const gl::TextureBuffer& from, const gl::TextureBuffer& to,
                              const gl::TextureBuffer& velocity, float dt) {
  bind();
  blocks_.check_later(to, expected_, dt);
  const bool searched = search(from, velocity);
  const bool look = searched && (driven_ || !answers_ || !none(offsetof(SurfaceControl, overflow)));
  while (look && make_room(true)) search(from, velocity);
  std::uint32_t overflow = 0;
  control_.download(&overflow, sizeof overflow, offsetof(SurfaceControl, overflow));
  return !no_room_ && overflow == 0;
}

void SurfacePairs::leave_out() {
  const std::uint32_t overflow = 1;
  control_.upload(&overflow, sizeof overflow, offsetof(SurfaceControl, overflow));
}

/// Makes lists longer that have too little room, or the search shorter, if they may not be longer: by the
/// sizes that the look before had copied, and queues a copy for the next look. The first look after
/// `invalidate`, and every look of a simulation that waits, reads its own copy at once. Returns true if the
/// pairs must be searched anew. That ends: a list grows until it has all it may have, and then the query
/// radius shrinks until it is the least.
bool SurfacePairs::make_room(bool within_step) {
  SurfaceControl control;
  const auto take = [&] {
    const std::span<const std::byte> seen = sizes_ring_.front(true);
    if (seen.size() >= sizeof control) std::memcpy(&control, seen.data(), sizeof control);
    sizes_ring_.pop();
  };
  if (!sizes_ring_.empty()) take();
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  sizes_ring_.push(control_, sizeof control);
  if (updates_ <= 1 || waits() || answers_) take();
  bool longer = false;
  const auto wanted = [&](std::uint32_t capacity, std::uint32_t found) {
    const bool full = 4 * std::uint64_t{found} > 3 * std::uint64_t{capacity} && capacity < most_;
    longer = longer || full;
    return full ? std::min(2 * std::min(found, most_), most_) : capacity;
  };
  const Capacities next{wanted(capacity_.leaf_pairs, control.most_leaf_pairs),
                        wanted(capacity_.bundle_pairs, control.most_bundle_pairs),
                        wanted(capacity_.triangle_pairs, control.most_triangle_pairs),
                        wanted(capacity_.pairs, control.most_pairs)};
  no_memory_ = longer && !may_have(next);
  if (no_memory_) longer = false;
  no_room_ = !longer && control.overflow != 0 && query_of(control) <= narrowest_query_;
  if (no_room_) return false;
  if (!longer && control.overflow == 0) {
    if (most_query_ < widest_query_ && 8 * std::uint64_t{control.most_pairs} < capacity_.pairs)
      limit_query(std::min(2.0f * most_query_, widest_query_));
    return false;
  }
  if (longer)
    make_lists(next);
  else
    limit_query(0.5f * query_of(control));  // rather a limit on speed than no steps at all
  forget_pairs(within_step);
  updates_ = 0;
  return true;
}

/// The query radius of the last search [m].
float SurfacePairs::query_of(const SurfaceControl& control) const {
  return std::min(std::bit_cast<float>(control.query), most_query_);
}

void SurfacePairs::bind() const {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  control_.bind_storage(slot_surface_control);
  control_.bind_uniform(slot_known_control);
  pairs_.bind(unit_surface_pairs);
  near_pairs_.bind(unit_near_pairs);
  near_pairs_.buffer.bind_storage(slot_near_pairs);
  chosen_pairs_.buffer.bind_storage(slot_chosen_pairs);
  chosen_pairs_.bind(unit_chosen_pairs);
}

void SurfacePairs::bind_contacts() const {
  pair_loads_.buffer.bind_storage(slot_pair_loads);
  contact_links_.buffer.bind_storage(slot_contact_links);
}

void SurfacePairs::bind_pushes() const {
  chosen_pairs_.bind(unit_chosen_pairs);
  pair_loads_.bind(unit_pair_loads);
  contact_links_.bind(unit_contact_links);
  contact_pushes_.bind(unit_contact_pushes);
  contact_pushes_.buffer.bind_storage(slot_contact_pushes);
}

void SurfacePairs::bind_term() const {
  chosen_pairs_.buffer.bind_storage(slot_term_chosen);
  chosen_pairs_.bind(unit_chosen_pairs);
  pairs_.bind(unit_surface_pairs);
}

void SurfacePairs::bind_energies() const {
  contact_pushes_.buffer.bind_storage(slot_term_energies);
  contact_pushes_.bind(unit_term_energies);
}

void SurfacePairs::set_limits(const gl::Program& program) const {
  program.set("most_query", most_query_);
  glProgramUniform1ui(program.id(), program.location("pair_capacity"), capacity_.pairs);
}

std::vector<SurfacePairs::Pair> SurfacePairs::read_pairs() const {
  SurfaceControl control;
  control_.download(&control, sizeof control);
  std::vector<std::array<std::uint32_t, 4>> words(std::min(control.pairs, capacity_.pairs));
  if (!words.empty()) pairs_.buffer.download(words.data(), words.size() * sizeof words[0]);
  std::vector<Pair> pairs;
  constexpr std::uint32_t bit = 0x80000000u;
  for (const auto& [a, b, c, d] : words)
    pairs.push_back({{a & ~bit, b & ~bit, c, d}, (a & bit) != 0, (b & bit) == 0});
  return pairs;
}

}  // namespace clothlab::sim
