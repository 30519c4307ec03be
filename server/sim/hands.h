// The hands that hold the cloth: a pass before each step and one after it, which together put a spring from
// each held vertex into whatever method steps (shaders/hands/hold.comp). Nothing runs while nobody holds the
// cloth.
#pragma once

#include <memory>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/hold.h"
#include "server/sim/state.h"

namespace clothlab::sim {

/// One hand: its hold, and where it would have the held vertex.
struct Hand {
  std::shared_ptr<const model::Hold> hold;
  model::dvec3 target{0.0};  ///< [m]
};

class Hands {
 public:
  bool empty() const { return hands_.empty(); }
  const std::vector<Hand>& all() const { return hands_; }
  /// True if `hands` are the same holds, whatever their targets.
  bool same_holds(const std::vector<Hand>& hands) const;

  /// Takes over the hands. `model`: the vertices as they lie in memory, at `places` (empty: in the scene's
  /// order). Where hands share a vertex their springs add up; a vertex that is pinned is left out. Error: the
  /// kernels cannot be made.
  Status set(std::vector<Hand> hands, const model::Model& model, const std::vector<std::uint32_t>& places);

  /// To be called before a step, on the state at its start: the state seen from outside stays as it was.
  void hold(StateBuffers& state, const scene::Scene& scene) const;
  /// To be called after a step, on the state at its end.
  void release(const StateBuffers& state) const;

 private:
  void run(const gl::Program& program, const StateBuffers& state) const;

  std::vector<Hand> hands_;
  std::uint32_t count_ = 0;  ///< of held vertices
  gl::Buffer held_;
  gl::Program hold_, release_;
};

}  // namespace clothlab::sim
