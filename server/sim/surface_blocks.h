// Tells when the pairs that a search for contact between surfaces has listed are no longer all that can meet
// (shaders/surface/block_motion.comp, block_pairs.comp). It follows the motion of blocks of triangles, so
// that a cloth which moves as a whole, or swings, needs few searches.
#pragma once

#include <cstdint>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/state.h"

namespace clothlab::sim {

class SurfaceBlocks {
 public:
  static Result<SurfaceBlocks> create(const model::Model& model);

  /// `skin` [m]: by how much a search reaches farther than it must.
  void set_skin(float skin);

  /// Asks for a search, in the control block that must be bound, if one is needed. `built`: the positions at
  /// the last search.
  void check(const StateBuffers& state, const gl::TextureBuffer& built) const;

 private:
  std::uint32_t block_count_ = 0;
  gl::Program motion_, pairs_;
  gl::TextureBuffer vertices_, boxes_;
};

}  // namespace clothlab::sim
