// What the passes of a step remember from one step to the next, besides places and velocities: first guesses,
// loads, what rounding took, lists of pairs. It belongs to the state: whoever keeps a state, or puts one
// back, does so with this. Each pass names what it remembers once, in `carry`; a Carrier copies it out of the
// pass or back into it.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "server/gl/buffer.h"

namespace clothlab::sim {

/// Copies of what passes remember, in the order in which they name it.
struct Carried {
  std::vector<gl::Buffer> buffers;
  std::vector<std::byte> numbers;

  std::size_t bytes() const;
};

class Carrier {
 public:
  /// Copies from passes to `copies`; buffers of the same size that it has are used again.
  static Carrier to(Carried& copies);
  /// Copies from `copies` to passes.
  static Carrier from(const Carried& copies);
  ~Carrier();
  Carrier(Carrier&&) = delete;

  /// True if it copies to passes.
  bool loads() const { return from_ != nullptr; }

  /// The first `bytes` of a buffer, or all of it. A copy of another length is left alone, and `fits` is
  /// false.
  void buffer(gl::Buffer& buffer, std::size_t bytes);
  void buffer(gl::Buffer& buffer) { this->buffer(buffer, buffer.bytes()); }
  /// What is on its way to the host in a ring of one slot. Waits for it.
  void ring(gl::ReadbackRing& ring);
  template <class Number>
  requires std::is_trivially_copyable_v<Number>
  void number(Number& number) { raw(&number, sizeof number); }
  /// False: what was asked for is not what the copies are of. Passes must then forget what they carry.
  bool fits() const { return fits_; }

 private:
  Carrier(Carried* to, const Carried* from);
  void raw(void* data, std::size_t bytes);

  Carried* to_;
  const Carried* from_;
  std::size_t next_buffer_ = 0, next_number_ = 0;
  bool fits_ = true;
};

}  // namespace clothlab::sim
