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
  /// The state at the start: the model's start positions, no velocity. The buffers have room for `extra`
  /// places behind its vertices, which are no part of the state (surface_bodies.h).
  StateBuffers(const model::Model& model, const MotionTable& motions, std::uint32_t extra = 0);
  /// Makes room for so many, if there is none yet: bodies may come while the simulation runs.
  void make_room(std::uint32_t extra);

  /// The present copy, which a pass reads. `swap` makes the other copy the present one.
  const gl::TextureBuffer& position() const { return position_[current_]; }
  const gl::TextureBuffer& velocity() const { return velocity_[current_]; }
  /// The state at the start of the last step, until the next step writes over it.
  const gl::TextureBuffer& previous_position() const { return position_[1 - current_]; }
  const gl::TextureBuffer& previous_velocity() const { return velocity_[1 - current_]; }
  void bind_for_step() const;  ///< the present copy for reading, the other for writing
  void bind_outputs() const;   ///< the other copy for writing
  void swap() { current_ = 1 - current_; }

  /// Makes the present copy that of another state, whole.
  void copy_from(const StateBuffers& other);

  /// To be called when a step has ended: everything outside of the step's passes now sees the present copy.
  void show();
  /// The state that is seen outside of a step's passes. While a step is under way: the state at its start.
  const gl::TextureBuffer& shown_position() const { return is_aside_ ? aside_position_ : position_[shown_]; }
  const gl::TextureBuffer& shown_velocity() const { return is_aside_ ? aside_velocity_ : velocity_[shown_]; }
  /// To be called before a pass at the start of a step writes over the present copy: until `show`, that copy
  /// as it was is what is seen outside, and what `give_up_step` goes back to.
  void put_aside();
  /// Gives up the step under way: goes back to the state at its start.
  void give_up_step();

  // The functions below may be called only while no step is under way, except `save` and `read`, which use
  // the shown state.
  /// Writes the state at the start: the model's start positions, no velocity.
  void reset(const model::Model& model, const MotionTable& motions);
  /// Writes changed masses and pins into the state, which otherwise stays as it is. Waits for the GPU.
  void rewrite_constants(const model::Model& model, const MotionTable& motions);
  /// `save` copies the shown state to buffers of the same size, `load` copies it back. Both on the GPU.
  void save(gl::Buffer& position, gl::Buffer& velocity) const;
  void load(const gl::Buffer& position, const gl::Buffer& velocity);
  State read() const;
  /// The inverse of `read`. Masses and pins are taken from the model.
  void write(const State& state, const model::Model& model, const MotionTable& motions);

 private:
  gl::TextureBuffer position_[2];  ///< xyz [m], w inverse mass [1/kg], 0 if pinned
  gl::TextureBuffer velocity_[2];  ///< xyz [m/s], w number of contacts; if pinned: index of its motion, or -1
  gl::TextureBuffer aside_position_, aside_velocity_;  ///< made by the first `put_aside`
  bool is_aside_ = false;
  std::uint32_t vertex_count_ = 0;
  int current_ = 0, shown_ = 0;
};

}  // namespace clothlab::sim
