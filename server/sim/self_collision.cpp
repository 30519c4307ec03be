#include "server/sim/self_collision.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

#include "server/sim/plan.h"
#include "server/sim/state.h"

namespace clothlab::sim {

namespace {

/// As in neighbours.glsl.
struct Control {
  std::uint32_t groups = 0, groups_y = 1, groups_z = 1;
  SelfCollision::Counters counters;
  std::uint32_t unused[2] = {};
  std::uint32_t finish_groups = 0, finish_groups_y = 1, finish_groups_z = 1;
};
constexpr GLintptr finish_offset = offsetof(Control, finish_groups);
static_assert(offsetof(Control, counters) == SelfCollision::counters_offset);

constexpr std::uint64_t updates_between_looks = 8;
constexpr std::uint32_t most_slots = 256;
constexpr std::uint64_t most_entries = std::uint64_t{1} << 22;  // 32 MiB, and what walking them takes

}  // namespace

Result<SelfCollision> SelfCollision::create(std::uint32_t vertex_count, std::uint32_t slots) {
  SelfCollision made;
  made.vertex_count_ = vertex_count;
  made.slots_ = slots;
  // Two cells a vertex keep the chains short.
  const std::uint32_t cells = std::bit_ceil(2 * vertex_count);
  const gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                            {"CELL_COUNT", std::to_string(cells)},
                            {"NEIGHBOUR_SLOTS", std::to_string(slots)}};
  for (auto [program, path] : {std::pair{&made.insert_, "collide/insert_cells.comp"},
                               {&made.find_, "collide/find_neighbours.comp"},
                               {&made.finish_, "collide/finish_lists.comp"}}) {
    Result<gl::Program> loaded = gl::Program::load({path}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    glProgramUniform1i(program->id(), 0, static_cast<GLint>(vertex_count));
  }
  const Control nothing;
  made.control_ = gl::Buffer(sizeof(Control), &nothing);
  made.seen_ = gl::ReadbackRing(sizeof(Control), 1);
  made.heads_ = {gl::Buffer(cells * sizeof(std::uint32_t)), GL_R32UI};
  made.heads_.buffer.fill(0xffffffffu);  // later each search leaves them empty
  made.chains_ = {gl::Buffer(vertex_count * sizeof(std::uint32_t)), GL_R32UI};
  made.counts_ = {gl::Buffer(vertex_count * sizeof(std::uint32_t)), GL_R32UI};
  made.lists_ = {gl::Buffer(std::size_t{vertex_count} * slots * 2 * sizeof(std::uint32_t)), GL_RG32UI};
  made.built_position_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
  return made;
}

void SelfCollision::set_parameters(const scene::SelfCollision& parameters, const model::Model& model) {
  // The skin trades rebuilds against list length: one edge of the mesh keeps a flat cloth's lists empty while
  // its contact distance is below an edge, since everything that near is joined by a spring.
  double edge = 0.0;
  for (const model::ClothRange& cloth : model.cloths) edge = std::max(edge, cloth.mean_edge_length);
  skin_ = static_cast<float>(std::max(edge, 0.5 * parameters.thickness));
  reach_ = static_cast<float>(parameters.thickness) + skin_;
  for (const gl::Program* program : {&insert_, &find_}) glProgramUniform1f(program->id(), 2, reach_);
  glProgramUniform1f(find_.id(), 3, static_cast<float>(parameters.thickness));
  invalidate();
}

void SelfCollision::invalidate() {
  const std::array<std::uint32_t, 3> dispatch{vertex_groups(vertex_count_), 1, 1};
  control_.upload(dispatch.data(), sizeof(dispatch));
  updates_ = 0;
}

void SelfCollision::update_lists() {
  control_.bind_storage(2);
  heads_.buffer.bind_storage(3);
  chains_.buffer.bind_storage(4);
  built_position_.buffer.bind_storage(5);
  counts_.buffer.bind_storage(6);
  lists_.buffer.bind_storage(7);
  heads_.bind(unit_neighbour_count);  // the search reads its hash where the step reads its lists
  chains_.bind(unit_neighbours);
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  for (const auto& [program, arguments] :
       {std::pair{&insert_, GLintptr{0}}, {&find_, GLintptr{0}}, {&finish_, finish_offset}}) {
    program->use();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glDispatchComputeIndirect(arguments);
  }
  if (updates_++ % updates_between_looks == 0) look();
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  counts_.bind(unit_neighbour_count);
  lists_.bind(unit_neighbours);
  built_position_.bind(unit_position_when_built);
}

/// What the lists were like at the look before; lists that somebody has just asked for at once.
void SelfCollision::look() {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const auto take = [&] {
    const std::span<const std::byte> seen = seen_.front(true);
    Control control;
    if (seen.size() < sizeof control) return;  // the device is lost
    std::memcpy(&control, seen.data(), sizeof control);
    longest_ = control.counters.longest;
    seen_.pop();
  };
  if (!seen_.empty()) take();
  if (seen_.full()) return;
  seen_.push(control_, sizeof(Control));
  if (updates_ == 1) take();
}

std::uint32_t SelfCollision::slots_needed() const {
  if (4 * std::uint64_t{longest_} <= 3 * std::uint64_t{slots_}) return slots_;
  const std::uint64_t wanted = std::bit_ceil(std::uint64_t{longest_} * 3 / 2);
  const bool too_many = wanted > most_slots || wanted * vertex_count_ > most_entries;
  return too_many ? slots_ : std::max(slots_, static_cast<std::uint32_t>(wanted));
}

void SelfCollision::take_counters(const SelfCollision& other) {
  Counters counters;
  other.control_.download(&counters, sizeof counters, counters_offset);
  counters.longest = 0;
  control_.upload(&counters, sizeof counters, counters_offset);
}

std::vector<std::vector<SelfCollision::Neighbour>> SelfCollision::read_lists() const {
  std::vector<std::uint32_t> counts(vertex_count_);
  std::vector<Neighbour> slots(std::size_t{vertex_count_} * slots_);
  counts_.buffer.download(counts.data(), counts.size() * sizeof(std::uint32_t));
  lists_.buffer.download(slots.data(), slots.size() * sizeof(Neighbour));
  std::vector<std::vector<Neighbour>> lists;
  for (std::size_t i = 0; i < vertex_count_; ++i) {
    const auto first = slots.begin() + static_cast<std::ptrdiff_t>(i * slots_);
    lists.emplace_back(first, first + counts[i]);
  }
  return lists;
}

}  // namespace clothlab::sim
