#include "server/sim/surface_pairs.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <set>
#include <span>
#include <string>

#include "server/sim/integrator.h"
#include "server/sim/surface_control.h"

namespace clothlab::sim {

namespace {

constexpr std::uint64_t updates_between_size_looks = 8;
constexpr std::uint32_t most_listed = 1u << 21;
constexpr std::uint32_t end_of_chain = 0xffffffffu;  // as in cells.glsl

/// The triangles, each with bits for the vertices (0 to 2) and edges (3 to 5) that it owns.
std::vector<std::array<std::uint32_t, 4>> owning_triangles(const model::Model& model) {
  std::vector<std::array<std::uint32_t, 4>> list;
  std::vector<bool> vertex_owned(model.vertex_count(), false);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const std::array<std::uint32_t, 3>& corners : model.triangles) {
    std::uint32_t owned = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % 3];
      if (!vertex_owned[a]) owned |= 1u << k;
      vertex_owned[a] = true;
      if (edges.emplace(std::min(a, b), std::max(a, b)).second) owned |= 8u << k;
    }
    list.push_back({corners[0], corners[1], corners[2], owned});
  }
  return list;
}

/// For each triangle the middle of its box at rest and its cloth, half of the box's sides, and its normal.
std::vector<glm::vec4> boxes_at_rest(const model::Model& model) {
  std::vector<glm::vec4> list;
  for (const auto& [a, b, c] : model.triangles) {
    const glm::vec3 x(model.rest_position[a]), y(model.rest_position[b]), z(model.rest_position[c]);
    const glm::vec3 low = glm::min(x, glm::min(y, z)), high = glm::max(x, glm::max(y, z));
    const glm::vec3 normal = glm::cross(y - x, z - x);
    const float size = glm::length(normal);
    list.emplace_back(0.5f * (low + high), static_cast<float>(model.vertex_cloth[a]));
    list.emplace_back(0.5f * (high - low), 0.0f);
    list.emplace_back(size > 0.0f ? normal / size : normal, 0.0f);
  }
  return list;
}

}  // namespace

Result<SurfacePairs> SurfacePairs::create(const model::Model& model) {
  SurfacePairs made;
  made.vertex_count_ = model.vertex_count();
  made.triangle_count_ = model.triangle_count();
  const std::uint32_t triangles = std::max(made.triangle_count_, 1u), cells = std::bit_ceil(2 * triangles);
  const gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                            {"CELL_COUNT", std::to_string(cells)}};
  for (auto [program, name] : {std::pair{&made.boxes_, "boxes"},
                               {&made.cells_program_, "cells"},
                               {&made.triangle_pairs_program_, "triangle_pairs"},
                               {&made.candidates_, "candidates"},
                               {&made.pairs_program_, "pairs"},
                               {&made.finish_, "finish"}}) {
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/") + name + ".comp"}, defines);
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("vertex_count", static_cast<GLint>(made.vertex_count_));
    program->set("triangle_count", static_cast<GLint>(made.triangle_count_));
  }
  Result<SurfaceBlocks> blocks = SurfaceBlocks::create(model);
  if (!blocks) return blocks.error();
  made.blocks_ = std::move(*blocks);
  made.control_ = gl::Buffer(sizeof(SurfaceControl));
  made.sizes_ring_ = gl::ReadbackRing(sizeof(SurfaceControl), 1);
  made.triangles_ = {gl::Buffer(owning_triangles(model)), GL_RGBA32UI};
  made.rest_boxes_ = {gl::Buffer(boxes_at_rest(model)), GL_RGBA32F};
  made.triangle_boxes_ = {gl::Buffer(triangles * 8 * sizeof(float)), GL_RGBA32F};
  made.cells_ = {gl::Buffer(cells * sizeof(std::uint32_t)), GL_R32UI};
  made.chains_ = {gl::Buffer(triangles * sizeof(std::uint32_t)), GL_R32UI};
  made.built_position_ = {gl::Buffer(made.vertex_count_ * 4 * sizeof(float)), GL_RGBA32F};
  made.make_lists(4 * made.triangle_count_ + 256, 8 * made.vertex_count_ + 256);
  const SurfaceControl nothing;
  made.control_.upload(&nothing, sizeof nothing);
  return made;
}

void SurfacePairs::make_lists(std::uint32_t triangle_pairs, std::uint32_t pairs) {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  const std::uint32_t most = std::min(most_listed, static_cast<std::uint32_t>(texels) / 3);
  triangle_pair_capacity_ = std::min(triangle_pairs, most);
  pair_capacity_ = std::min(pairs, most);
  triangle_pairs_ = {gl::Buffer(std::size_t{triangle_pair_capacity_} * 2 * sizeof(std::uint32_t)), GL_RG32UI};
  pairs_ = {gl::Buffer(std::size_t{pair_capacity_} * 4 * sizeof(std::uint32_t)), GL_RGBA32UI};
  near_pairs_ = {gl::Buffer(std::size_t{pair_capacity_} * 12 * sizeof(std::uint32_t)), GL_RGBA32UI};
  chosen_pairs_ = gl::Buffer(std::size_t{pair_capacity_} * 2 * sizeof(std::uint32_t));
  for (const gl::Program* program : {&triangle_pairs_program_, &candidates_, &pairs_program_, &finish_}) {
    glProgramUniform1ui(program->id(), program->location("triangle_pair_capacity"), triangle_pair_capacity_);
    glProgramUniform1ui(program->id(), program->location("pair_capacity"), pair_capacity_);
  }
}

void SurfacePairs::set_parameters(const scene::Scene& scene, const model::Model& model) {
  const double thickness = scene.self_collision->thickness;
  double edge = 0.0;
  for (const model::ClothRange& cloth : model.cloths)
    edge = edge > 0.0 ? std::min(edge, cloth.mean_edge_length) : cloth.mean_edge_length;
  // Parts of a flat grid that share no vertex are 0.7 of a cell's side apart, which is 0.6 of the mean edge.
  // A search that reaches less far for what is side by side lists nothing then.
  skin_ = static_cast<float>(std::max(0.55 * edge - 1.2 * thickness, 0.3 * edge));
  const auto least_query = static_cast<float>(std::min(1.2 * thickness, 0.25 * edge));
  blocks_.set_skin(skin_);
  for (const gl::Program* program :
       {&boxes_, &cells_program_, &triangle_pairs_program_, &candidates_, &pairs_program_, &finish_}) {
    program->set("dt", static_cast<float>(scene.solver.dt));
    program->set("thickness", static_cast<float>(thickness));
    program->set("skin", skin_);
    program->set("least_query", least_query);
  }
  limit_query(static_cast<float>(24.0 * edge + 4.0 * thickness));
}

void SurfacePairs::limit_query(float most) {
  most_query_ = most;
  for (const gl::Program* program :
       {&boxes_, &cells_program_, &triangle_pairs_program_, &candidates_, &pairs_program_, &finish_})
    program->set("most_query", most);
}

void SurfacePairs::invalidate() {
  SurfaceControl control;
  control_.download(&control, sizeof control);
  const std::uint32_t rebuilds = control.rebuilds, cuts = control.cuts;
  control = SurfaceControl{};
  control.rebuilds = rebuilds;
  control.cuts = cuts;
  control.rebuild[0] = vertex_groups(std::max(vertex_count_, triangle_count_));
  control_.upload(&control, sizeof control);
  cells_.buffer.fill(end_of_chain);
  updates_ = 0;
}

void SurfacePairs::search(const StateBuffers& state) {
  const auto dispatch = [](const gl::Program& program, std::size_t groups) {
    program.use();
    glDispatchComputeIndirect(static_cast<GLintptr>(groups));
    wait_for_writes();
  };
  state.position().bind(unit_position);
  state.velocity().bind(unit_velocity);
  triangles_.bind(unit_surface_triangles);
  rest_boxes_.bind(unit_rest_boxes);
  triangle_boxes_.bind(unit_triangle_boxes);
  cells_.bind(unit_triangle_cells);
  chains_.bind(unit_triangle_chains);
  triangle_pairs_.bind(unit_triangle_pairs);
  control_.bind_storage(slot_surface_control);
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  triangle_boxes_.buffer.bind_storage(slot_triangle_boxes);
  built_position_.buffer.bind_storage(slot_surface_built);
  dispatch(boxes_, offsetof(SurfaceControl, rebuild));
  cells_.buffer.bind_storage(slot_triangle_cells);
  chains_.buffer.bind_storage(slot_triangle_chains);
  dispatch(cells_program_, offsetof(SurfaceControl, rebuild));
  triangle_pairs_.buffer.bind_storage(slot_triangle_pairs);
  dispatch(triangle_pairs_program_, offsetof(SurfaceControl, rebuild));
  near_pairs_.buffer.bind_storage(slot_near_pairs);
  near_pairs_.bind(unit_near_pairs);
  dispatch(candidates_, offsetof(SurfaceControl, split));
  pairs_.buffer.bind_storage(slot_surface_pairs);
  dispatch(pairs_program_, offsetof(SurfaceControl, candidate_groups));
  cells_.buffer.bind_storage(slot_triangle_cells);
  dispatch(finish_, offsetof(SurfaceControl, rebuild));
}

Work SurfacePairs::update(const StateBuffers& state) {
  wait_for_writes();
  bind();
  blocks_.check(state, built_position_);
  search(state);
  for (int attempt = 0; updates_++ % updates_between_size_looks == 0 && read_sizes() && attempt < 4;
       ++attempt) {
    co_await may_stop;
    search(state);
  }
}

/// Makes lists longer that have too little room (or the search shorter, if they may not be longer), by the
/// sizes that the look before had copied, and queues a copy for the next look. The first look after
/// `invalidate` reads its own copy at once. Returns true if the pairs must be searched anew.
bool SurfacePairs::read_sizes() {
  SurfaceControl control;
  const auto take = [&] {
    const std::span<const std::byte> seen = sizes_ring_.front(true);
    if (seen.size() >= sizeof control) std::memcpy(&control, seen.data(), sizeof control);
    sizes_ring_.pop();
  };
  if (!sizes_ring_.empty()) take();
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  sizes_ring_.push(control_, sizeof control);
  if (updates_ == 1) take();
  const auto wanted = [](std::uint32_t capacity, std::uint32_t found) {
    return 4 * std::uint64_t{found} > 3 * std::uint64_t{capacity} ? std::min(2 * found, most_listed)
                                                                  : capacity;
  };
  const std::uint32_t triangle_pairs = wanted(triangle_pair_capacity_, control.most_triangle_pairs),
                      pairs = wanted(pair_capacity_, control.most_pairs);
  if (triangle_pairs > triangle_pair_capacity_ || pairs > pair_capacity_)
    make_lists(std::max(triangle_pairs, triangle_pair_capacity_), std::max(pairs, pair_capacity_));
  else if (control.overflow != 0)
    limit_query(0.5f * most_query_);  // no list may be longer: rather a limit on speed than no steps at all
  else
    return false;
  invalidate();
  return true;
}

void SurfacePairs::bind() const {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, control_.id());
  control_.bind_storage(slot_surface_control);
  pairs_.bind(unit_surface_pairs);
  near_pairs_.bind(unit_near_pairs);
  near_pairs_.buffer.bind_storage(slot_near_pairs);
  chosen_pairs_.bind_storage(slot_chosen_pairs);
}

void SurfacePairs::set_limits(const gl::Program& program) const {
  program.set("most_query", most_query_);
  glProgramUniform1ui(program.id(), program.location("pair_capacity"), pair_capacity_);
}

std::vector<SurfacePairs::Pair> SurfacePairs::read_pairs() const {
  SurfaceControl control;
  control_.download(&control, sizeof control);
  std::vector<std::array<std::uint32_t, 4>> words(std::min(control.pairs, pair_capacity_));
  if (!words.empty()) pairs_.buffer.download(words.data(), words.size() * sizeof words[0]);
  std::vector<Pair> pairs;
  constexpr std::uint32_t bit = 0x80000000u;
  for (const auto& [a, b, c, d] : words)
    pairs.push_back({{a & ~bit, b & ~bit, c, d}, (a & bit) != 0, (b & bit) == 0});
  return pairs;
}

}  // namespace clothlab::sim
