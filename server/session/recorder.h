// Records what happens in a session, on a thread of its own, so that no step waits for prediction and
// compression. The session's thread uses this class; what is recorded goes into its Exchange.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/session/exchange.h"
#include "server/stream/frame.h"
#include "server/stream/recording.h"

namespace clothlab::session {

class Recorder {
 public:
  /// A recording ends by itself with the second in which it gets beyond `most` bytes.
  Recorder(Exchange& exchange, std::size_t most) : exchange_(exchange), most_(most) {}
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Starts a recording of this document; the last one is forgotten. Must not be busy.
  void start(double rate, const json& document, const std::string& name);
  /// True from `start` to `stop`.
  bool recording() const { return recording_; }
  /// True until `poll` has told the end.
  bool busy() const { return thread_.joinable(); }

  // While `recording`. Frames are f32; those of another mesh than the last one are left out, and so are some
  // while many wait.
  void mesh(std::shared_ptr<const model::Model> model, std::shared_ptr<const scene::Scene> scene,
            std::uint32_t revision);
  void frame(stream::SharedMessage frame);
  void change(json change);
  void stop();

  /// How the recording ended, once: `limit` if it had as many bytes as it may have, `failed` for want of
  /// memory.
  enum class End { asked, limit, failed };
  std::optional<End> poll();

 private:
  struct Mesh {
    std::shared_ptr<const model::Model> model;
    std::shared_ptr<const scene::Scene> scene;
    std::uint32_t revision = 0;
  };
  struct Stop {};
  using Task = std::variant<Mesh, stream::SharedMessage, json, Stop>;

  void add(Task task);
  void run(double rate, const json& document, RecordingFacts facts);
  End record(stream::Recording& writer, std::string& bytes, RecordingFacts& facts);
  void perform(Task& task, stream::Recording& writer);
  void write(const stream::Message& frame, stream::Recording& writer);

  Exchange& exchange_;
  const std::size_t most_;
  bool recording_ = false;

  std::mutex mutex_;  // held to move a task, never while one is performed
  std::condition_variable task_arrived_;
  std::deque<Task> tasks_;
  bool ending_ = false;
  std::thread thread_;
  std::atomic<bool> done_{false};
  End end_ = End::asked;  ///< once `done_`

  // Of the recorder's own thread.
  std::uint32_t revision_ = 0;
  double time_ = 0;  ///< of the last frame [s]
};

}  // namespace clothlab::session
