#include "server/sim/surface_blocks.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/sim/integrator.h"

namespace clothlab::sim {

Result<SurfaceBlocks> SurfaceBlocks::create(const SurfaceTriangles& surface, std::uint32_t vertex_count) {
  SurfaceBlocks made;
  const std::vector<std::vector<std::uint32_t>>& blocks = surface.blocks;
  made.block_count_ = static_cast<std::uint32_t>(blocks.size());
  std::vector<std::uint32_t> words;
  std::size_t end = blocks.size();
  for (const std::vector<std::uint32_t>& block : blocks)
    words.push_back(static_cast<std::uint32_t>(end += block.size()));
  for (const std::vector<std::uint32_t>& block : blocks)
    words.insert(words.end(), block.begin(), block.end());
  made.vertices_ = {gl::Buffer(words), GL_R32UI};
  Result<gl::Program> loaded =
      gl::Program::load({"surface/blocks.comp"}, {{"GROUP_SIZE", std::to_string(group_size)}});
  if (!loaded) return loaded.error();
  made.program_ = std::move(*loaded);
  made.program_.set("block_count", static_cast<GLint>(made.block_count_));
  made.program_.set("cloth_block_count", static_cast<GLint>(surface.cloth_block_count));
  made.program_.set("vertex_count", static_cast<GLint>(vertex_count));
  made.program_.set("triangle_count", static_cast<GLint>(surface.triangles.size()));
  return made;
}

void SurfaceBlocks::set_skin(float skin) {
  program_.set("skin", skin);
}

void SurfaceBlocks::check(const StateBuffers& state, const gl::TextureBuffer& built) const {
  bind(state, built);
  glDispatchCompute(1, 1, 1);
  wait_for_writes();
}

void SurfaceBlocks::check_again(const StateBuffers& state, const gl::TextureBuffer& built,
                                std::size_t groups) const {
  bind(state, built);
  glDispatchComputeIndirect(static_cast<GLintptr>(groups));
  wait_for_writes();
}

void SurfaceBlocks::bind(const StateBuffers& state, const gl::TextureBuffer& built) const {
  state.position().bind(unit_position);
  built.bind(unit_position_when_built);
  vertices_.bind(unit_block_vertices);
  program_.use();
}

}  // namespace clothlab::sim
