// Packs a simulation's present state into frames on the GPU: bounds, normals, a field, quantisation,
// readback, without stalling the steps.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "server/base/result.h"
#include "server/sim/simulation.h"
#include "server/stream/frame.h"

namespace clothlab::stream {

class Packer {
 public:
  /// The first frame gets the sequence number `last` + 1.
  static Result<std::unique_ptr<Packer>> create(std::uint32_t last = 0);
  ~Packer();

  /// Queues the packing of the present state after the steps queued so far; `colliders` becomes the frame's
  /// Message::colliders. A frame of the encoding c16 is packed only: Compressor makes it. False if the
  /// readback ring is full: try again after the next poll.
  bool request(const sim::Simulation& simulation, Form form, std::uint16_t flags,
               std::string_view colliders = {});

  /// The oldest finished frame, or null if none has finished. Never waits. Sequence numbers rise by one with
  /// each frame.
  SharedMessage poll();

  /// Waits for the oldest requested frame; null if none was requested.
  SharedMessage wait();

 private:
  Packer();
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::stream
