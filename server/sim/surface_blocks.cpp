#include "server/sim/surface_blocks.h"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

/// Smaller blocks bend less, and so need fewer searches; all pairs of blocks are looked at in every step.
constexpr std::size_t triangles_in_block = 16, most_blocks = 128;

/// Halves `triangles` along their longest extent until each part has at most `most`; calls `take` on each.
template <class Take>
void halve(std::span<std::uint32_t> triangles, const std::vector<model::dvec3>& middle, std::size_t most,
           const Take& take) {
  if (triangles.size() <= most) return take(triangles);
  model::dvec3 low = middle[triangles[0]], high = low;
  for (const std::uint32_t triangle : triangles) {
    low = glm::min(low, middle[triangle]);
    high = glm::max(high, middle[triangle]);
  }
  const model::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return std::pair(middle[a][axis], a) < std::pair(middle[b][axis], b);
                   });
  halve(triangles.first(half), middle, most, take);
  halve(triangles.subspan(half), middle, most, take);
}

/// The vertices of each block, each once. Blocks are compact at the start, and hold as many triangles as each
/// other, more or less.
std::vector<std::vector<std::uint32_t>> blocks_of_triangles(const model::Model& model) {
  std::vector<model::dvec3> middle;
  for (const auto& [a, b, c] : model.triangles)
    middle.push_back((model.start_position[a] + model.start_position[b] + model.start_position[c]) / 3.0);
  std::vector<std::uint32_t> triangles(model.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::vector<std::vector<std::uint32_t>> blocks;
  if (triangles.empty()) return blocks;
  // Halving ends with half of these or more.
  const std::size_t most = std::max(triangles_in_block, 2 * triangles.size() / most_blocks + 1);
  halve(std::span(triangles), middle, most, [&](std::span<const std::uint32_t> block) {
    std::vector<std::uint32_t>& vertices = blocks.emplace_back();
    for (const std::uint32_t triangle : block)
      vertices.insert(vertices.end(), model.triangles[triangle].begin(), model.triangles[triangle].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  });
  return blocks;
}

}  // namespace

Result<SurfaceBlocks> SurfaceBlocks::create(const model::Model& model) {
  SurfaceBlocks made;
  const std::vector<std::vector<std::uint32_t>> blocks = blocks_of_triangles(model);
  made.block_count_ = static_cast<std::uint32_t>(blocks.size());
  std::vector<std::uint32_t> words;
  std::size_t end = blocks.size();
  for (const std::vector<std::uint32_t>& block : blocks)
    words.push_back(static_cast<std::uint32_t>(end += block.size()));
  for (const std::vector<std::uint32_t>& block : blocks)
    words.insert(words.end(), block.begin(), block.end());
  made.vertices_ = {gl::Buffer(words), GL_R32UI};
  made.boxes_ = {gl::Buffer(std::max<std::size_t>(blocks.size(), 1) * 16 * sizeof(float)), GL_RGBA32F};
  for (auto [program, name] : {std::pair{&made.motion_, "block_motion"}, {&made.pairs_, "block_pairs"}}) {
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/") + name + ".comp"},
                                                   {{"GROUP_SIZE", std::to_string(group_size)}});
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("block_count", static_cast<GLint>(made.block_count_));
    program->set("vertex_count", static_cast<GLint>(model.vertex_count()));
    program->set("triangle_count", static_cast<GLint>(model.triangle_count()));
  }
  return made;
}

void SurfaceBlocks::set_skin(float skin) {
  pairs_.set("skin", skin);
}

void SurfaceBlocks::check(const StateBuffers& state, const gl::TextureBuffer& built) const {
  state.position().bind(unit_position);
  built.bind(unit_position_when_built);
  vertices_.bind(unit_block_vertices);
  boxes_.bind(unit_block_boxes);
  boxes_.buffer.bind_storage(slot_block_boxes);
  for (const gl::Program* program : {&motion_, &pairs_}) {
    program->use();
    glDispatchCompute(vertex_groups(block_count_), 1, 1);
    wait_for_writes();
  }
}

}  // namespace clothlab::sim
