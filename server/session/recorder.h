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
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>

#include "server/base/memory_budget.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/session/exchange.h"
#include "server/stream/frame.h"
#include "server/stream/recording.h"

namespace clothlab::session {

class Recorder {
 public:
  /// A recording ends by itself with the second in which it gets beyond `most` bytes, or beyond what `budget`
  /// (null: any) has for it.
  Recorder(Exchange& exchange, std::size_t most, std::shared_ptr<MemoryBudget> budget = nullptr)
      : exchange_(exchange), most_(most), budget_(std::move(budget)) {}
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Starts a recording of this document, of so many vertices; the last one is forgotten. Must not be busy.
  /// Error: there is no memory for the frames on their way; nothing has changed.
  clothlab::Status start(double rate, const json& document, const std::string& name, std::uint32_t vertices);
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

  /// How the recording ended, once: `limit` if it had as many bytes as it may have, `memory` if the budget
  /// had no more, `failed` for want of memory.
  enum class End { asked, limit, memory, failed };
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
  void append(std::string& bytes, std::string_view more);
  End record(stream::Recording& writer, std::string& bytes, RecordingFacts& facts);
  void perform(Task& task, stream::Recording& writer);
  void write(const stream::Message& frame, stream::Recording& writer);

  Exchange& exchange_;
  const std::size_t most_;
  const std::shared_ptr<MemoryBudget> budget_;
  bool recording_ = false;

  std::mutex mutex_;  // held to move a task, never while one is performed
  std::condition_variable task_arrived_;
  std::deque<Task> tasks_;
  bool ending_ = false;
  std::thread thread_;
  std::atomic<bool> done_{false};
  End end_ = End::asked;  ///< once `done_`

  // Of the recorder's own thread, once it runs.
  double rate_ = 0;                     ///< [1/s]
  MemoryBudget::Reservation memory_{};  ///< of the file and of `under_way_`
  std::size_t under_way_ = 0;           ///< bytes of frames that wait, and of the group that is written
  bool out_of_memory_ = false;
  std::uint32_t revision_ = 0;
  std::optional<std::pair<double, double>> times_{};  ///< of the first and the last frame [s]
};

}  // namespace clothlab::session
