// Between the order in which vertices lie in memory (server/model/numbering.h) and the scene's, in which they
// are handed out.
#pragma once

#include <cstdint>
#include <vector>

#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/sim/simulation.h"
#include "shaders/slots.h"

namespace clothlab::sim {

class SceneOrder {
 public:
  SceneOrder() = default;
  /// `places` [vertex_count], or empty: both orders are the same, and nothing is copied.
  static Result<SceneOrder> create(const std::vector<std::uint32_t>& places);

  State to_scene(State in_memory) const;
  State to_memory(State in_scene) const;
  /// Positions in the scene's order. Copies them on the GPU, into the same buffer each time.
  const gl::TextureBuffer& to_scene(const gl::TextureBuffer& in_memory) const;
  /// Binds the places in memory of the scene's vertices; false if both orders are the same.
  bool bind_places() const {
    if (!places_.empty()) place_texels_.bind(unit_places);
    return !places_.empty();
  }

 private:
  std::vector<std::uint32_t> places_;
  gl::Program copy_;
  gl::TextureBuffer place_texels_, in_scene_;
};

}  // namespace clothlab::sim
