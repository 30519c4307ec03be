// The state of every vertex on the GPU, kept twice: a step reads one copy and writes the other.
#pragma once

#include "server/gl/buffer.h"
#include "server/model/model.h"
#include "server/sim/simulation.h"
#include "shaders/slots.h"

namespace clothlab::sim {

class MotionTable;

class StateBuffers {
 public:
  StateBuffers() = default;
  /// At rest: the model's start positions, no velocity.
  StateBuffers(const model::Model& model, const MotionTable& motions);

  /// The copy that a pass reads; after `swap` the other one.
  const gl::TextureBuffer& position() const { return position_[current_]; }
  const gl::TextureBuffer& velocity() const { return velocity_[current_]; }
  /// Where the last step began, until the next one.
  const gl::TextureBuffer& previous_position() const { return position_[1 - current_]; }
  void bind_for_step() const;  ///< the present copy for reading, the other for writing
  void bind_outputs() const;   ///< the other copy for writing
  void swap() { current_ = 1 - current_; }

  /// The step has ended: the present copy is what others than its passes see from now on.
  void show() { shown_ = current_; }
  /// What they see; while a step is under way, where it began.
  const gl::TextureBuffer& shown_position() const { return position_[shown_]; }
  const gl::TextureBuffer& shown_velocity() const { return velocity_[shown_]; }
  /// A step that has begun is not wanted: back to where it began, which it has not written over yet.
  void give_up_step() { current_ = shown_; }

  // What follows is for when no step is under way, but for `save` and `read`: they take what is shown.
  /// Back to the start.
  void reset(const model::Model& model, const MotionTable& motions);
  /// Writes changed masses and pins into the state, which otherwise stays as it is. Waits for the GPU.
  void rewrite_constants(const model::Model& model, const MotionTable& motions);
  /// Copies the present state to, or from, buffers of the same size, on the GPU.
  void save(gl::Buffer& position, gl::Buffer& velocity) const;
  void load(const gl::Buffer& position, const gl::Buffer& velocity);
  State read() const;
  /// The inverse; masses and pins are the model's.
  void write(const State& state, const model::Model& model, const MotionTable& motions);

 private:
  gl::TextureBuffer position_[2];  ///< xyz [m], w inverse mass [1/kg], 0 if pinned
  gl::TextureBuffer velocity_[2];  ///< xyz [m/s], w contacts, or of a pinned vertex its motion's index or -1
  int current_ = 0, shown_ = 0;
};

}  // namespace clothlab::sim
