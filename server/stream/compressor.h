// Makes c16 frames of packed ones on a thread of its own, so that no step waits for it. The thread that steps
// uses this class.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/model/model.h"
#include "server/stream/frame.h"
#include "server/stream/predictor.h"

namespace clothlab::stream {

/// The payload of a c16 frame behind front_room and a header: of a frame that Packer has packed for c16.
SharedMessage compress(const Message& packed, const Predictor& predictor);

class Compressor {
 public:
  Compressor() = default;
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  /// Frames offered from here on are of this mesh.
  void set_mesh(const model::Model& model, std::uint32_t revision);
  /// True if two frames wait: the next one would only be older when its turn comes.
  bool full() const;
  /// Adds a frame as Packer makes it for c16. The first call starts the thread.
  void offer(SharedMessage packed);
  /// The oldest finished frame, or null. Never waits.
  SharedMessage poll();
  /// True until `poll` has given every frame that was offered.
  bool busy() const { return offered_ != given_; }

 private:
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  struct Task {
    SharedMessage packed;
    std::shared_ptr<const Triangles> triangles;
  };
  void run();

  std::shared_ptr<const Triangles> triangles_;
  std::uint32_t revision_ = 0, offered_ = 0, given_ = 0;

  mutable std::mutex mutex_;  // held to move a frame, never while one is compressed
  std::condition_variable task_arrived_;
  std::deque<Task> waiting_;
  std::deque<SharedMessage> done_;  ///< null: there was not enough memory
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace clothlab::stream
