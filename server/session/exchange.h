// All that passes between a session's thread and the service thread: commands in; events, a status and the
// latest frame of each encoding out. Its locks are held only to move a pointer or swap a vector.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <list>
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
#include "server/session/refusal.h"
#include "server/session/run_state.h"
#include "server/session/saved.h"
#include "server/sim/simulation.h"
#include "server/stream/frame.h"

namespace clothlab::session {

using Clock = std::chrono::steady_clock;

// Events from a session.
struct Started {
  std::string renderer;
};
struct Failed {
  Error error;
  bool no_opengl = false;  ///< before anything of the scene was tried
};
struct Reply {
  Ticket ticket;
  std::variant<json, Refusal> answer;
};
/// The document has changed: by `patch`, or as a whole where there is none.
struct SceneChanged {
  std::shared_ptr<const scene::Document> document;
  std::uint64_t revision = 0;
  std::optional<json> patch;
  std::uint64_t by = 0;
};
struct TopologyChanged {
  stream::SharedMessage message;
};
struct PartsChanged {
  std::vector<sim::Simulation::Part> parts;
};
/// What sim.status says of the solver; see server/net/asyncapi.yaml.
struct SolverChanged {
  json facts;
};
struct Diverged {
  std::string reason;
  std::string remedy;
  json patch;
};
struct Notice {
  const char* level = "info";  ///< info | warning | error
  std::string text;
};
/// All that is needed to draw a moment of a simulation elsewhere.
struct Moment {
  std::shared_ptr<const scene::Document> document;
  double time = 0;                           ///< [s]
  std::vector<glm::vec3> positions{};        ///< [vertex] [m]
  std::vector<scene::Collider> colliders{};  ///< where they are then
};
struct Captured {
  std::uint64_t asker = 0;
  Export what;
  Result<Moment> moment;
};
struct SceneReached {
  std::uint64_t job = 0;
};
/// There is no scene to measure: the session has failed.
struct SceneLost {
  std::uint64_t job = 0;
};
struct Held {
  std::uint64_t job = 0;
};
/// The scene's method is `auto`, and the lab is to choose for it.
struct ChoiceWanted {};
/// What sim.status is made of; plain data, so that the session's thread allocates nothing for it.
struct Status {
  RunState run;
  double speed = 1, real_time_factor = 0;
  double dt_limit = 0;           ///< [s]; infinite: none, 0: no step is stable
  std::optional<double> margin;  ///< dt over dt_limit; none where that says nothing
  sim::Diagnostics diagnostics;
  gl::StageTimes pass_times;  ///< those that have arrived since the last status
};
using Event = std::variant<Started, Failed, Reply, SceneChanged, TopologyChanged, PartsChanged, SolverChanged,
                           Diverged, Notice, Captured, SceneReached, SceneLost, Held, ChoiceWanted, Status>;

class Exchange {
 public:
  static constexpr std::size_t commands_a_turn = 8;

  /// `wake` is called on the session's thread after something has been put out; it must not block.
  explicit Exchange(std::function<void()> wake) : wake_(std::move(wake)) {}

  // The service thread's side.
  /// What a client asks for. False: it has max_waiting_commands waiting already.
  [[nodiscard]] bool offer(Command command);
  /// What the server itself has to say; see CommandQueue::post.
  void post(Command command);
  void stop();
  void take_events(std::vector<Event>& out);  ///< `out` is emptied first
  stream::SharedMessage frame(stream::Encoding encoding) const;
  /// The latest that the session kept of itself, null before the first time.
  std::shared_ptr<const Saved> kept() const;
  /// Who waits for an answer that a session which has failed will not give: answered with `error`, as events.
  void give_up(const Error& error, std::vector<Event>& out);
  std::int64_t heartbeat_us() const { return heartbeat_us_.load(std::memory_order_relaxed); }
  std::uint64_t steps() const { return steps_.load(std::memory_order_relaxed); }

  // The session's side.
  /// Waits for a command until `until`; false: the session is to end. `out` is emptied first, and gets no
  /// more than `commands_a_turn`, so that a session with much to do still ends, beats and shows frames.
  bool take_commands(std::vector<Command>& out, Clock::time_point until);
  void emit(Event event);
  /// An event, of which only the newest waits: it says what was before it, and nothing of what comes after.
  void publish(const Status& status);
  void publish(stream::SharedMessage frame);
  void forget_frames();  ///< what is in the mailbox no longer shows the present
  void forget_frame(stream::Encoding encoding);
  void beat();
  /// What the session could be brought back from.
  void keep(std::shared_ptr<const Saved> saved);
  void count_steps(std::uint64_t steps) { steps_.fetch_add(steps, std::memory_order_relaxed); }

 private:
  /// An answer that is still to be given: to a request, for a picture or mesh, or to the lab.
  struct Awaited {
    Ticket ticket;
    std::optional<std::uint64_t> job;
  };
  static std::optional<Awaited> answer_to(const Command& command);
  void settle(const Event& event);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable commands_changed_;
  CommandQueue commands_;
  std::vector<Event> events_;
  std::array<stream::SharedMessage, encoding_count> frames_;
  std::list<Awaited> awaited_;  ///< as asked; settled near its front
  std::shared_ptr<const Saved> kept_;
  bool stopping_ = false;
  std::atomic<std::int64_t> heartbeat_us_{0};
  std::atomic<std::uint64_t> steps_{0};
};

/// Steady clock now [us], as Message::made_at_us counts.
std::int64_t now_us();

}  // namespace clothlab::session
