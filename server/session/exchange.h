// All that passes between a session's thread and the service thread: commands in; events, a status and the
// latest frame of each encoding out. The lock is held only to move a pointer or swap a vector.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/gl/stage_timer.h"
#include "server/lab/measure/choice.h"
#include "server/scene/document.h"
#include "server/session/command_queue.h"
#include "server/session/hands.h"
#include "server/session/recording_facts.h"
#include "server/session/refusal.h"
#include "server/session/run_state.h"
#include "server/session/saved.h"
#include "server/sim/blow_up.h"
#include "server/sim/simulation.h"
#include "server/stream/frame.h"

namespace clothlab::session {

using Clock = std::chrono::steady_clock;

/// Time between two events of `rate` events per second.
inline Clock::duration period(double rate) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
}

// Events from a session.
struct Started {
  std::string renderer;
};
struct Failed {
  Error error;
  bool no_opengl = false;  ///< true: no OpenGL context can be made; the scene was not tried
};
/// A JSON value as text: made once, on the session's thread, for all who get it.
using JsonText = std::shared_ptr<const std::string>;
JsonText text_of(const json& value);
struct Reply {
  Ticket ticket;
  std::variant<JsonText, Refusal> answer;
};
/// The document has changed by `patch`, or, without a patch, as a whole. `by` is the asker, 0: the server.
struct SceneChanged {
  std::shared_ptr<const scene::Document> document;
  JsonText text;  ///< {"document", "revision"}, as `scene` and scene.get tell them
  std::uint64_t revision = 0;
  std::optional<json> patch;
  std::uint64_t by = 0;
  bool told = false;  ///< viewers know of it already
};
/// What can be undone and redone now; see server/net/asyncapi.yaml.
struct HistoryChanged {
  json told;
};
struct TopologyChanged {
  stream::SharedMessage message;
  std::vector<std::uint32_t> renumbered{};  ///< cloths of whose vertices the document counts others
};
struct PartsChanged {
  std::vector<sim::Simulation::Part> parts;
};
/// The solver's part of sim.status; see server/net/asyncapi.yaml.
struct SolverChanged {
  json facts;
};
struct Diverged {
  std::string reason;
  std::string remedy;
  json patch;
  sim::BlowUp::Energy energy{};
};
struct Notice {
  const char* level = "info";  ///< info | warning | error
  std::string text;
  bool standing = false;        ///< also for each client that comes later
  const char* about = nullptr;  ///< what it is about, if clients may tell that in a way of their own; or null
};
/// In the place of the session's file is what could not be restored, and could not be moved: threads of the
/// session to come must not save there either.
struct FileTaken {};
/// A notification for all viewers, whose text another process has made.
struct Told {
  std::string text;
  bool status = false;  ///< it is a sim.status: a newer one replaces it
};
/// All that another thread needs to draw the scene at one moment.
struct Moment {
  std::shared_ptr<const scene::Document> document;
  double time = 0;                           ///< [s]
  std::vector<glm::vec3> positions{};        ///< [vertex] [m]
  std::vector<scene::Collider> colliders{};  ///< as placed at `time`
  /// Not null: instead of all that, a recording to make a page of, with the name in `title`.
  std::shared_ptr<const std::string> recording{};
  std::string title{};
};
struct Captured {
  std::uint64_t asker = 0;
  Export what;
  Result<Moment> moment;
};
struct SceneReached {
  std::uint64_t job = 0;
};
/// Answers ReachScene after the session has failed: there is no scene to measure.
struct SceneLost {
  std::uint64_t job = 0;
};
struct Held {
  std::uint64_t job = 0;
};
/// The scene's method is `auto`, and the lab has to choose settings for it.
struct ChoiceWanted {};
/// The content of sim.status as plain data, so that the session's thread allocates nothing for it.
struct Status {
  RunState run;
  double speed = 1, real_time_factor = 0;
  bool paced = false;            ///< it steps by the clock, and real_time_factor is measured
  std::size_t memory_bytes = 0;  ///< of all buffers on the device
  double dt_limit = 0;           ///< [s]; infinite: any step is stable, 0: no step is
  std::optional<double> margin;  ///< dt over dt_limit; none: any step is stable, or no step is
  sim::Diagnostics diagnostics;
  sim::Convergence convergence;
  std::vector<HandAt> hands;  ///< empty, and so without memory, while nobody holds the cloth
  gl::StageTimes pass_times;  ///< the GPU times that have arrived since the last status
};
using Event = std::variant<Started, Failed, Reply, SceneChanged, HistoryChanged, TopologyChanged,
                           PartsChanged, SolverChanged, Diverged, Notice, FileTaken, Told, Captured,
                           SceneReached, SceneLost, Held, ChoiceWanted, Status>;

class Exchange {
 public:
  /// What a client has sent just before it left is still done, if that begins and ends within this time.
  static constexpr std::chrono::seconds leave_time{1};

  /// `wake` is called on the session's thread after each new event or frame; it must not block.
  explicit Exchange(std::function<void()> wake) : wake_(std::move(wake)) {}

  // For the service thread:
  /// Adds a client's command. False: max_waiting_commands of this client wait already.
  [[nodiscard]] bool offer(Command command);
  /// Adds a command of the server itself; see CommandQueue::post.
  void post(Command command);
  /// A client has left: what it still asks for is forgotten after `leave_time`.
  void leave(std::uint64_t asker);
  void stop();
  void take_events(std::vector<Event>& out);  ///< `out` is emptied first
  stream::SharedMessage frame(stream::Form form) const;
  /// The newest saved state of the session, null before the first.
  std::shared_ptr<const Saved> saved() const;
  /// What has been recorded, or is.
  RecordingFacts recording() const;
  /// After the session has failed: answers each of its open commands with `error`, as events added to `out`.
  void give_up(const Error& error, std::vector<Event>& out);
  std::int64_t heartbeat_us() const { return heartbeat_us_.load(std::memory_order_relaxed); }
  std::uint64_t steps() const { return steps_.load(std::memory_order_relaxed); }

  // For the session's thread:
  /// Waits for a command until `until`. False: the session has to end.
  bool wait_for_command(Clock::time_point until);
  /// The next command; none: none waits.
  std::optional<Command> next_command();
  /// The last command taken has needed so long.
  void spent(Clock::duration time);
  /// Why a change of the scene that `asker` has asked for, and that is being built, is to be given up; none:
  /// it goes on.
  struct GiveUp {
    enum class Why { stopping, left, undone, loaded } why = Why::stopping;
    Ticket by{};  ///< of the scene.undo, or of the scene.load
  };
  std::optional<GiveUp> to_give_up(std::uint64_t asker, bool an_undo) const;
  bool stopping() const;
  void emit(Event event);
  /// While it lives, events are held back; at its end the service thread gets them all at once. So a viewer
  /// who comes when a change has been answered is greeted with the changed scene. Not nested.
  class Batch {
   public:
    explicit Batch(Exchange& exchange) : exchange_(exchange) { exchange_.hold_events(); }
    ~Batch() { exchange_.release_events(); }
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;

   private:
    Exchange& exchange_;
  };
  /// Adds a status to the events and removes older statuses that still wait. The new status comes after all
  /// waiting events, as it shows the state after them.
  void publish(const Status& status);
  void publish(stream::SharedMessage frame);
  void forget_frames();  ///< removes the latest frames, as they no longer show the present state
  void forget_frame(stream::Form form);  ///< called by the service thread
  void beat();                           ///< sets the heartbeat to now
  /// Stores the state from which the session can be restored.
  void store_saved(std::shared_ptr<const Saved> saved);
  void store_recording(RecordingFacts facts);  ///< any thread may call it
  void count_steps(std::uint64_t steps) { steps_.fetch_add(steps, std::memory_order_relaxed); }

 private:
  /// Notes the answer that the session will owe for a command, if it will: to a request, to an Export, or to
  /// a job of the lab.
  void await_answer(Ticket ticket, std::optional<std::uint64_t> job, bool exports);
  void remove_awaited(const Ticket& answered);
  void remove_awaited(const Event& event);
  void hold_events();
  void release_events();  ///< allocates nothing, as it must not fail

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable commands_changed_;
  CommandQueue commands_;
  std::vector<Event> events_;
  bool holding_ = false;                             ///< a batch is open
  std::ptrdiff_t held_from_ = 0;                     ///< index of its first event; 0 if none is open
  std::map<std::uint64_t, Clock::time_point> left_;  ///< askers that have left with commands open, and when
  std::array<stream::SharedMessage, form_count> frames_;
  /// The requests and Exports that are to be answered, by asker, in the order of asking: the next one is near
  /// the front, however many wait.
  std::map<std::uint64_t, std::list<Ticket>> awaited_;
  std::map<std::uint64_t, Ticket> awaited_jobs_;  ///< jobs of the lab that are to be answered
  std::shared_ptr<const Saved> saved_;
  RecordingFacts recording_;
  bool stopping_ = false;
  std::atomic<std::int64_t> heartbeat_us_{0};
  std::atomic<std::uint64_t> steps_{0};
};

/// The present time on the steady clock [us], as in Message::made_at_us.
std::int64_t now_us();

}  // namespace clothlab::session
