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
  std::vector<std::uint32_t> words;
  std::size_t end = blocks.size();
  for (const std::vector<std::uint32_t>& block : blocks)
    words.push_back(static_cast<std::uint32_t>(end += block.size()));
  for (const std::vector<std::uint32_t>& block : blocks)
    words.insert(words.end(), block.begin(), block.end());
  made.vertices_ = {gl::Buffer(words), GL_R32UI};
  made.motions_ = {gl::Buffer(std::max<std::size_t>(blocks.size(), 1) * 8 * sizeof(float)), GL_RGBA32F};
  for (auto [program, name] :
       {std::pair{&made.motions_program_, "block_motions"}, {&made.program_, "blocks"}}) {
    Result<gl::Program> loaded = gl::Program::load({std::string("surface/") + name + ".comp"},
                                                   {{"GROUP_SIZE", std::to_string(group_size)}});
    if (!loaded) return loaded.error();
    *program = std::move(*loaded);
    program->set("block_count", static_cast<GLint>(blocks.size()));
    program->set("cloth_block_count", static_cast<GLint>(surface.cloth_block_count));
    program->set("vertex_count", static_cast<GLint>(vertex_count));
    program->set("triangle_count", static_cast<GLint>(surface.triangles.size()));
  }
  return made;
}

void SurfaceBlocks::set_parameters(float skin, float dt) {
  program_.set("most_skin", skin);
  program_.set("dt", dt);
}

void SurfaceBlocks::check(const gl::TextureBuffer& position, const gl::TextureBuffer& expected) const {
  check_later(position, expected, 0.0f);
}

void SurfaceBlocks::check_later(const gl::TextureBuffer& position, const gl::TextureBuffer& expected,
                                float later) const {
  run(position, expected, later, [] { glDispatchCompute(1, 1, 1); });
}

void SurfaceBlocks::check_again(const gl::TextureBuffer& position, const gl::TextureBuffer& expected,
                                std::size_t groups) const {
  run(position, expected, 0.0f, [&] { glDispatchComputeIndirect(static_cast<GLintptr>(groups)); });
}

template <class Dispatch>
void SurfaceBlocks::run(const gl::TextureBuffer& position, const gl::TextureBuffer& expected, float later,
                        const Dispatch& dispatch) const {
  position.bind(unit_position);
  expected.bind(unit_expected);
  vertices_.bind(unit_block_vertices);
  motions_.bind(unit_block_motions);
  motions_.buffer.bind_storage(slot_block_motions);
  for (const gl::Program* program : {&motions_program_, &program_}) {
    program->use();
    program->set("later", later);
    dispatch();
    wait_for_writes();
  }
}

}  // namespace clothlab::sim
