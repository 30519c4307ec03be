// The vertices of bodies of triangles, for contact between surfaces: the state's buffers hold them behind the
// cloths' vertices, pinned, and this places them in every step (shaders/surface/bodies.comp).
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/motion_table.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"
#include "server/sim/surface_triangles.h"

namespace clothlab::sim {

class SurfaceBodies {
 public:
  static Result<SurfaceBodies> create(const model::Model& model, const Plan& plan,
                                      const SurfaceTriangles& surface);

  /// Takes over places, friction, restitution and motions. `invalidate` must follow.
  void set_parameters(const scene::Scene& scene, const model::Model& model, const MotionTable& motions);

  /// Places added to the state's vertices.
  std::uint32_t count() const { return static_cast<std::uint32_t>(places_.size()); }
  bool moves() const { return moves_; }
  /// True if the next step changes places of bodies, or sets them for the first time.
  bool changes() const { return moves_ || steps_since_ < 2; }

  void invalidate() { steps_since_ = 0; }
  /// Places the bodies in the state's present copy: where they are at the start of the step at `row` of the
  /// motion table, or at its end.
  void place_at_start(const StateBuffers& state, int row) const;
  void place_at_end(const StateBuffers& state, int row);
  /// Writes where they are at the end of the step, and how fast, into other buffers of the state's size.
  void place_end(const gl::Buffer& position, const gl::Buffer& velocity, int row) const {
    place(position, velocity, row, end_row_);
  }
  /// For kernels that ask for the friction of bodies, or what is inside boxes.
  void bind() const { buffer_.bind(unit_body_places); }

 private:
  void place(const gl::Buffer& position, const gl::Buffer& velocity, int start_row, int row) const;

  std::vector<BodyPlace> places_;
  bool moves_ = false;
  int end_row_ = 0;
  int steps_since_ = 0;  ///< `invalidate`: both copies of a state need places that do not move
  gl::Program program_;
  gl::TextureBuffer buffer_;
};

}  // namespace clothlab::sim
