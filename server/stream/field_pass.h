// Computes a field at every vertex on the GPU, and the range of its bytes: the largest value, which falls
// slowly once the cloth is quieter. Nothing waits for the GPU.
#pragma once

#include <array>
#include <cstddef>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/sim/simulation.h"
#include "server/stream/form.h"

namespace clothlab::stream {

class FieldPass {
 public:
  static Result<FieldPass> create();

  /// Forgets the ranges so far: another cloth follows.
  void set_mesh(std::uint32_t vertex_count);
  /// Queues the field of the present state, leaves its values bound at slot_field, and tells `reader`, which
  /// includes field.glsl, about them. `field` must not be Field::none.
  void compute(const sim::Simulation& simulation, Field field, const gl::Program& reader);

 private:
  struct Values {
    gl::Buffer buffer;  ///< two peaks, then the values; empty until somebody wants this field
    int turn = 0;       ///< which of the peaks is the newest
    double time = 0;    ///< of the newest peak [s], simulated
  };
  std::array<gl::Program, fields.size()> programs_;
  std::array<Values, fields.size()> values_;
  std::uint32_t vertex_count_ = 0;
};

}  // namespace clothlab::stream
