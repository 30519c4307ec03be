#include "server/sim/self_collision.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <span>

#include "server/base/text.h"
#include "server/model/crowding.h"
#include "server/model/thickness.h"
#include "server/sim/integrator.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"

namespace clothlab::sim {

namespace {

using Clock = std::chrono::steady_clock;

/// The buffer NeighbourControl in neighbours.glsl.
struct NeighbourControl {
  std::array<std::uint32_t, 3> rebuild{0, 1, 1};
  SelfCollision::Counters counters;
  std::array<std::uint32_t, 3> search{0, 0, 1};
  std::array<std::uint32_t, 3> finish{0, 1, 1};
};
static_assert(offsetof(NeighbourControl, counters) == SelfCollision::counters_offset);

/// Most pairs of vertices that one search may look at: about three seconds on a slow processor.
constexpr double most_pairs = 1e9;
/// Pairs that one dispatch of a search looks at, about: a few milliseconds on a slow processor.
constexpr double pairs_a_dispatch = 2e6;
constexpr std::chrono::milliseconds long_dispatch{10};

constexpr std::uint64_t updates_between_looks = 8;
constexpr std::uint32_t most_slots = 256;
constexpr std::uint64_t most_slots_in_all = std::uint64_t{1} << 22;  // 32 MiB, and time to read them
constexpr std::uint32_t chain_end = 0xffffffffu;                     // as in cells.glsl

}  // namespace

Result<SelfCollision> SelfCollision::create(const model::Model& model, std::uint32_t slots) {
  SelfCollision made;
  const std::uint32_t vertex_count = model.vertex_count();
  made.vertex_count_ = vertex_count;
  made.slots_ = slots;
  // With two cells per vertex the chains stay short.
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
    program->set("vertex_count", static_cast<GLint>(vertex_count));
  }
  const NeighbourControl nothing;
  made.control_ = gl::Buffer(sizeof(NeighbourControl), &nothing);
  made.answers_ = gl::AnswersAtOnce::of_device();
  made.counters_ring_ = gl::ReadbackRing(sizeof(NeighbourControl), 1);
  made.heads_ = {gl::Buffer(cells * sizeof(std::uint32_t)), GL_R32UI};
  made.heads_.buffer.fill(chain_end);  // later each search empties the heads at its end
  made.chains_ = {gl::Buffer(vertex_count * 4 * sizeof(std::uint32_t)), GL_RGBA32UI};
  made.counts_ = {gl::Buffer(vertex_count * sizeof(std::uint32_t)), GL_R32UI};
  made.lists_ = {gl::Buffer(std::size_t{vertex_count} * slots * 2 * sizeof(std::uint32_t)), GL_RG32UI};
  made.excluded_ = {gl::Buffer(model.contact_exclusions.items), GL_R32UI};
  made.first_excluded_ = {gl::Buffer(model.contact_exclusions.offsets), GL_R32UI};
  made.built_position_ = {gl::Buffer(vertex_count * 4 * sizeof(float)), GL_RGBA32F};
  return made;
}

Status SelfCollision::set_parameters(const scene::SelfCollision& parameters, const model::Model& model) {
  // A thicker skin makes rebuilds rarer but lists longer. With a skin of one mesh edge, and a thickness below
  // one edge, the lists of a flat cloth are empty: vertices that near to each other share an element. Of
  // several cloths the finest decides: with another's skin each of its vertices would list all that lie about
  // it.
  const double edge = model::least_mean_edge(model);
  const double skin = std::max(edge, 0.5 * parameters.thickness), reach = parameters.thickness + skin;
  const bool same = static_cast<float>(reach) == reach_;
  const double candidates = same ? candidates_ : model::crowding(model.start_position, 2.0 * reach);
  const double pairs = candidates * vertex_count_;
  if (pairs > most_pairs)
    return Error{"/self_collision/thickness",
                 with_significant_digits(parameters.thickness, 3) + " m on a mesh with edges of " +
                     with_significant_digits(edge, 3) + " m: the neighbour search would compare each of " +
                     std::to_string(vertex_count_) + " vertices with about " + formatted("%.0f", candidates) +
                     " others",
                 "at most " + formatted("%.0e", most_pairs) +
                     " pairs in a search: a thickness of about one edge, or a coarser mesh"};
  candidates_ = candidates;
  skin_ = static_cast<float>(skin);
  reach_ = static_cast<float>(reach);
  for (const gl::Program* program : {&insert_, &find_}) program->set("reach", reach_);
  find_.set("thickness", static_cast<float>(parameters.thickness));
  if (!same)
    limit_range(static_cast<std::uint32_t>(
        std::clamp(pairs_a_dispatch / std::max(candidates * group_size, 1.0), 1.0, 1e6)));
  invalidate();
  return ok();
}

void SelfCollision::limit_range(std::uint32_t groups) {
  range_groups_ = std::clamp(groups, 1u, vertex_groups(vertex_count_));
}

void SelfCollision::invalidate() {
  const NeighbourControl control{{vertex_groups(vertex_count_), 1, 1}, {}, {range_groups_, 0, 1}, {0, 1, 1}};
  control_.upload(&control.rebuild, sizeof control.rebuild, offsetof(NeighbourControl, rebuild));
  control_.upload(&control.search, sizeof control.search + sizeof control.finish,
                  offsetof(NeighbourControl, search));
  heads_.buffer.fill(chain_end);  // a search that was given up has left vertices in the cells
  updates_ = 0;
  searched_ = updated_ = false;
}

void SelfCollision::give_up_step() {
  NeighbourControl now;
  control_.download(&now, sizeof now);
  // What the step's end has asked for is of places that are given up. A search that was under way begins
  // anew.
  const bool searching = !updated_ && (now.rebuild[0] > 0 || now.finish[0] > 0);
  now.rebuild[0] = searching ? vertex_groups(vertex_count_) : 0;
  now.search = {range_groups_, 0, 1};
  now.finish = {0, 1, 1};
  control_.upload(&now, sizeof now);
  if (searching) heads_.buffer.fill(chain_end);
}

void SelfCollision::carry(Carrier& carrier) {
  bool searched = searched_;
  NeighbourControl control;
  if (!carrier.loads()) control_.download(&control, sizeof control);
  carrier.number(searched);
  carrier.number(control.rebuild);
  carrier.number(control.counters);
  carrier.number(updates_);
  carrier.number(updated_);
  carrier.number(longest_);
  carrier.ring(counters_ring_);
  carrier.buffer(built_position_.buffer);
  if (!carrier.loads() || !carrier.fits()) return;
  const std::uint64_t updates = updates_;
  const bool updated = updated_;
  invalidate();
  if (searched) search_again();
  updates_ = updates;
  updated_ = updated;
  control_.upload(&control.rebuild, sizeof control.rebuild, offsetof(NeighbourControl, rebuild));
  control_.upload(&control.counters, sizeof control.counters, counters_offset);
}

/// Makes the lists that were found at `built_position_`.
void SelfCollision::search_again() {
  gl::TextureBuffer places{gl::Buffer(built_position_.buffer.bytes()), GL_RGBA32F};
  places.buffer.copy_from(built_position_.buffer);
  places.bind(unit_position);
  bind();
  Work work = search();
  for (Pace unlimited; !work.done();) work.resume(unlimited);
  wait_for_writes();
}

void SelfCollision::bind() const {
  control_.bind_storage(slot_neighbour_control);
  heads_.buffer.bind_storage(slot_cell_heads);
  chains_.buffer.bind_storage(slot_cell_chains);
  built_position_.buffer.bind_storage(slot_position_when_built);
  counts_.buffer.bind_storage(slot_neighbour_count);
  lists_.buffer.bind_storage(slot_neighbours);
  heads_.bind(unit_cell_heads);
  chains_.bind(unit_cell_chains);
  counts_.bind(unit_neighbour_count);
  lists_.bind(unit_neighbours);
  built_position_.bind(unit_position_when_built);
  excluded_.bind(unit_excluded);
  first_excluded_.bind(unit_first_excluded);
}

Work SelfCollision::update_lists() {
  bind();
  if (updated_) co_return;
  if (search_is_due()) co_await search();
  if (updates_++ % updates_between_looks == 0) read_counters();
  updated_ = true;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

/// Whether lists may have to be rebuilt.
bool SelfCollision::search_is_due() const {
  return !answers_.none(control_, offsetof(NeighbourControl, rebuild));
}

Work SelfCollision::search() {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  const auto dispatch = [](std::size_t arguments) {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glDispatchComputeIndirect(static_cast<GLintptr>(arguments));
  };
  insert_.use();
  dispatch(offsetof(NeighbourControl, rebuild));
  find_.use();
  const auto range = static_cast<GLint>(range_groups_) * group_size;
  Clock::duration longest{};
  for (GLint first = 0; first < static_cast<GLint>(vertex_count_); first += range) {
    find_.set("first_vertex", first);
    const Clock::time_point begun = Clock::now();
    dispatch(offsetof(NeighbourControl, search));
    longest = std::max(longest, Clock::now() - begun);
    if (range < static_cast<GLint>(vertex_count_)) co_await may_stop;
  }
  finish_.use();
  dispatch(offsetof(NeighbourControl, finish));
  searched_ = true;
  // With software OpenGL a dispatch has ended when the call returns. One that takes long shows that the cloth
  // has crumpled since its start, and each range must become smaller.
  if (longest > long_dispatch && range_groups_ > 1) {
    limit_range(range_groups_ / 2);
    control_.upload(&range_groups_, sizeof range_groups_, offsetof(NeighbourControl, search));
  }
}

/// Reads back the counters that the look before had copied, and queues a copy for the next look. The first
/// look after `invalidate` reads its own copy at once.
void SelfCollision::read_counters() {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const auto take = [&] {
    const std::span<const std::byte> seen = counters_ring_.front(true);
    NeighbourControl control;
    if (seen.size() < sizeof control) return;  // the device is lost
    std::memcpy(&control, seen.data(), sizeof control);
    longest_ = control.counters.longest;
    counters_ring_.pop();
  };
  if (!counters_ring_.empty()) take();
  if (counters_ring_.full()) return;
  counters_ring_.push(control_, sizeof(NeighbourControl));
  if (updates_ == 1) take();
}

std::uint32_t SelfCollision::slots_needed() const {
  if (4 * std::uint64_t{longest_} <= 3 * std::uint64_t{slots_}) return slots_;
  const std::uint64_t wanted = std::bit_ceil(std::uint64_t{longest_} * 3 / 2);
  const bool too_many = wanted > most_slots || wanted * vertex_count_ > most_slots_in_all;
  return too_many ? slots_ : std::max(slots_, static_cast<std::uint32_t>(wanted));
}

void SelfCollision::take_counters(const SelfCollision& other) {
  Counters counters;
  other.control_.download(&counters, sizeof counters, counters_offset);
  counters.longest = 0;
  control_.upload(&counters, sizeof counters, counters_offset);
}

std::vector<std::vector<SelfCollision::Neighbour>> SelfCollision::read_lists() const {
  if (!searched_) return {};
  std::vector<std::uint32_t> counts(vertex_count_);
  std::vector<Neighbour> slots(std::size_t{vertex_count_} * slots_);
  counts_.buffer.download(counts.data(), counts.size() * sizeof(std::uint32_t));
  lists_.buffer.download(slots.data(), slots.size() * sizeof(Neighbour));
  std::vector<std::vector<Neighbour>> lists;
  for (std::size_t i = 0; i < vertex_count_; ++i) {
    const auto first = slots.begin() + static_cast<std::ptrdiff_t>(i * slots_);
    lists.emplace_back(first, first + std::min(counts[i], slots_));
  }
  return lists;
}

}  // namespace clothlab::sim
