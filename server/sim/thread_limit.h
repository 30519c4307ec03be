// The triangles of finite elements whose warp and weft have a strain limit, as
// shaders/strain_limit/sheet.glsl reads them.
#pragma once

#include "server/gl/buffer.h"
#include "server/sim/carried.h"
#include "server/sim/element_lists.h"

namespace clothlab::sim {

class ThreadLimit {
 public:
  ThreadLimit() = default;
  /// Takes the cloths of finite elements that have a strain limit.
  ThreadLimit(const model::Model& model, const scene::Scene& scene);

  /// Takes over rest shapes, masses and pins, which may change without new kernels.
  void set_parameters(const model::Model& model);
  void bind() const;
  void restart() { pulls_.fill(0); }
  void carry(Carrier& carrier) { carrier.buffer(pulls_); }

 private:
  std::vector<std::uint32_t> triangles_;  ///< [limited triangle] its membrane's number in the model
  gl::TextureBuffer first_corner_, corners_, records_;
  gl::Buffer pulls_;
};

}  // namespace clothlab::sim
