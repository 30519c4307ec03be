// What a session's thread does, turn by turn: commands, a piece of a step or some steps, frames, diagnostics.
// It owns the simulation and its GL context, which is current on the thread that calls it. The state after N
// steps depends on the scene alone, never on who watches: viewers only decide when frames are packed, and
// whether an unwatched session goes on at all.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/scene/document.h"
#include "server/session/automatic.h"
#include "server/session/engine.h"
#include "server/session/exchange.h"
#include "server/session/limits.h"
#include "server/session/piece_size.h"
#include "server/session/real_time.h"
#include "server/session/rest.h"
#include "server/session/run_state.h"
#include "server/session/step_limit.h"
#include "server/sim/guarded_run.h"

namespace clothlab::session {

class Stepper {
 public:
  /// `document` is loaded and plays at once. Unwatched for `patience` [s], it stops until it is watched
  /// again.
  /// Its frames are numbered from after `last_frame`.
  static Result<std::unique_ptr<Stepper>> create(scene::Document document, Exchange& exchange,
                                                 const Limits& limits, std::optional<int> gpu = std::nullopt,
                                                 std::uint32_t last_frame = 0,
                                                 double patience = unwatched_seconds);

  /// GL_RENDERER.
  const std::string& renderer() const { return engine_->context->device().name; }
  /// The device was reset: nothing of this works any more.
  bool lost() const { return engine_->context->lost(); }

  /// Goes on from where a session of this document was. Error: it is of another mesh.
  clothlab::Status bring_back(const Saved& saved);
  /// What it can be brought back from; waits for the GPU.
  Saved saved();
  /// Rises with every change of what `saved` says.
  std::uint64_t version() const { return state_version_ + revision_; }

  /// Handles `commands`, then does the work that is due; returns when the next turn is, if no command comes
  /// before.
  Clock::time_point turn(std::vector<Command>& commands);

 private:
  struct Waiting {  // a sim.step that is not finished
    Ticket ticket;
    std::uint64_t until_step = 0;
  };
  using Answer = std::variant<json, Refusal>;

  Stepper(scene::Document document, Exchange& exchange, const Limits& limits, std::optional<int> gpu,
          double patience)
      : document_(std::move(document)),
        exchange_(exchange),
        limits_(limits),
        gpu_(gpu),
        patience_(patience) {}
  sim::Simulation& simulation() const { return *engine_->simulation; }
  const scene::Scene& scene() const {
    return simulation().scene();
  }  ///< as stepped: its method is never "auto"
  FrameMaker& frames() const { return *engine_->frames; }
  /// The scene to step for a document (see Automatic), checked before anything is made for it.
  Result<scene::Scene> prepare(const scene::Document& document);

  // stepper_commands.cpp; each answers its ticket where it has one.
  void handle(Command& command);
  void perform(GetScene&, const Ticket& ticket);
  void perform(LoadScene& load, const Ticket& ticket);
  void perform(PatchScene& patch, const Ticket& ticket);
  void perform(Play&, const Ticket& ticket);
  void perform(Pause&, const Ticket& ticket);
  void perform(Step& step, const Ticket& ticket);
  void perform(Reset&, const Ticket& ticket);
  void perform(Speed& speed, const Ticket& ticket);
  void perform(Demand& demand, const Ticket& ticket);
  void perform(Watchers& watchers, const Ticket& ticket);
  void perform(Export& what, const Ticket& ticket);
  void perform(ReachScene& reach, const Ticket& ticket);
  void perform(Hold& hold, const Ticket& ticket);
  void perform(Release&, const Ticket& ticket);
  void perform(Chosen& chosen, const Ticket& ticket);
  void reply(const Ticket& ticket, Answer answer);
  json where_we_are() const;
  static Refusal diverged_refusal();
  Result<sim::ChangeDepth> change(const scene::Scene& scene);
  Result<sim::ChangeDepth> change_engine(const scene::Scene& scene);
  Result<sim::ChangeDepth> move_to(const scene::Scene& scene, gl::HelperThreads threads);
  void adopt(scene::Document document, sim::ChangeDepth depth);
  void take_over(scene::Document document, sim::ChangeDepth depth);
  void restart();
  void state_replaced();
  void announce_scene(std::optional<json> patch, std::uint64_t by);
  void announce_parts();
  void announce_solver();

  // stepper.cpp
  void advance(Clock::time_point now);
  void want_steps(Clock::time_point now, bool run);
  void note_finished(Clock::time_point now);
  void finish_waiting(bool all);
  void follow_diagnostics(Clock::time_point now);
  void request_diagnosis(Clock::time_point now);
  void accept(sim::GuardedRun::Verdict verdict);
  void fall_asleep();
  void wake_up();
  void diverge();
  void go_on();
  void publish_status(Clock::time_point now);
  void follow_step_limit();
  void warn_if_slow(Clock::time_point now);
  void warn_if_crowded();
  void warn_if_unconverged();
  void warn_if_thin();
  bool suspended(Clock::time_point now) const;
  bool running(Clock::time_point now) const { return run_.steps() && !suspended(now); }
  Clock::time_point next_turn(Clock::time_point now) const;

  scene::Document document_;  ///< as the clients know it; see scene()
  Exchange& exchange_;
  Limits limits_;
  std::optional<int> gpu_;
  double patience_;  ///< [s]
  std::unique_ptr<Engine> engine_;
  PieceSize piece_size_;
  RealTime real_time_;
  StepLimit step_limit_;
  Rest rest_;
  Automatic automatic_;

  std::uint64_t revision_ = 1;
  std::uint32_t topology_revision_ = 0;
  RunState run_;
  bool was_running_ = false;
  std::vector<Waiting> waiting_;
  int watchers_ = 0;
  Clock::time_point last_watched_{};

  std::optional<sim::GuardedRun> guard_;  ///< there is one as soon as there is an engine
  std::uint64_t state_version_ = 1,
                diagnosed_version_ = 0;  ///< whether the diagnostics are of the present state
  Clock::time_point next_status_{}, next_diagnosis_{};
  Clock::time_point slow_since_{};
  bool slow_announced_ = false, crowded_announced_ = false, unconverged_announced_ = false;
  bool thin_ = false;  ///< layers of cloth can pass through each other
};

}  // namespace clothlab::session
