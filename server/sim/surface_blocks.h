// Tells when the pairs that a search for contact between surfaces has listed are no longer all that can meet
// (shaders/surface/blocks.comp). It follows the motion of blocks of triangles, so that a cloth which falls,
// or goes on as it went at the search, needs few searches.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/sim/plan.h"
#include "server/sim/surface_triangles.h"

namespace clothlab::sim {

class SurfaceBlocks {
 public:
  /// More than so many blocks do not fit the one work group that compares all of them in every step. Smaller
  /// blocks bend less, and so need fewer searches.
  static constexpr std::uint32_t most_blocks = group_size;

  static Result<SurfaceBlocks> create(const SurfaceTriangles& surface, std::uint32_t vertex_count);

  /// `skin`: by how much a search reaches farther than it must, at most [m]; `dt`: of the steps [s].
  void set_parameters(float skin, float dt);

  /// Asks for a search, in the control block that must be bound, if one is needed. `expected`:
  /// of each vertex, as shaders/surface/expected.glsl has it.
  void check(const gl::TextureBuffer& position, const gl::TextureBuffer& expected) const;
  /// The same for the places where all will be so much later [s].
  void check_later(const gl::TextureBuffer& position, const gl::TextureBuffer& expected, float later) const;
  /// The same, dispatched indirectly: `groups` is the offset in the control block of 1, or of 0 to do
  /// nothing.
  void check_again(const gl::TextureBuffer& position, const gl::TextureBuffer& expected,
                   std::size_t groups) const;

 private:
  template <class Dispatch>
  void run(const gl::TextureBuffer& position, const gl::TextureBuffer& expected, float later,
           const Dispatch& dispatch) const;

  gl::Program motions_program_, program_;
  gl::TextureBuffer vertices_, motions_;
};

}  // namespace clothlab::sim
