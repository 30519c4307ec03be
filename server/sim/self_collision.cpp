#include "server/sim/self_collision.h"

#include <algorithm>
#include <array>
#include <bit>

#include "server/sim/plan.h"
#include "server/sim/state.h"

namespace clothlab::sim {

Result<SelfCollision> SelfCollision::create(std::uint32_t vertex_count) {
  SelfCollision made;
  made.vertex_count_ = vertex_count;
  // Two cells a vertex keep the chains short.
  const std::uint32_t cells = std::bit_ceil(2 * vertex_count);
  const gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                            {"CELL_COUNT", std::to_string(cells)}};
  for (auto [program, path] : {std::pair{&made.clear_, "collide/clear_cells.comp"},
                               {&made.insert_, "collide/insert_cells.comp"},
                               {&made.find_, "collide/find_neighbours.comp"}}) {
    Result<gl::Program> loaded = gl::Program::load({path}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    glProgramUniform1i(program->id(), 0, static_cast<GLint>(vertex_count));
  }
  made.control_ = gl::Buffer(5 * sizeof(std::uint32_t));
  made.heads_ = {gl::Buffer(cells * sizeof(std::uint32_t)), GL_R32UI};
  made.chains_ = {gl::Buffer(vertex_count * sizeof(std::uint32_t)), GL_R32UI};
  made.counts_ = {gl::Buffer(vertex_count * sizeof(std::uint32_t)), GL_R32UI};
  made.lists_ = {gl::Buffer(vertex_count * neighbour_slots * 2 * sizeof(std::uint32_t)), GL_RG32UI};
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
  for (const gl::Program* program : {&clear_, &insert_, &find_}) {
    program->use();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glDispatchComputeIndirect(0);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  counts_.bind(unit_neighbour_count);
  lists_.bind(unit_neighbours);
  built_position_.bind(unit_position_when_built);
}

std::vector<std::vector<SelfCollision::Neighbour>> SelfCollision::read_lists() const {
  std::vector<std::uint32_t> counts(vertex_count_);
  std::vector<Neighbour> slots(vertex_count_ * neighbour_slots);
  counts_.buffer.download(counts.data(), counts.size() * sizeof(std::uint32_t));
  lists_.buffer.download(slots.data(), slots.size() * sizeof(Neighbour));
  std::vector<std::vector<Neighbour>> lists;
  for (std::size_t i = 0; i < vertex_count_; ++i) {
    const auto first = slots.begin() + static_cast<std::ptrdiff_t>(i * neighbour_slots);
    lists.emplace_back(first, first + counts[i]);
  }
  return lists;
}

}  // namespace clothlab::sim
