// The work of a session's thread, turn by turn: commands, a piece of a step or some steps, frames,
// diagnostics. The stepper owns the simulation and its GL context, which is current on the thread that calls
// the stepper. The state after N steps depends on the scene alone, not on viewers: they only decide when
// frames are packed, and whether the session goes on stepping.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "server/base/pieces.h"
#include "server/scene/document.h"
#include "server/session/automatic.h"
#include "server/session/engine.h"
#include "server/session/exchange.h"
#include "server/session/hands.h"
#include "server/session/history.h"
#include "server/session/limits.h"
#include "server/session/mesh_shelf.h"
#include "server/session/piece_size.h"
#include "server/session/real_time.h"
#include "server/session/recorder.h"
#include "server/session/rest.h"
#include "server/session/run_state.h"
#include "server/session/step_limit.h"
#include "server/session/timeline.h"
#include "server/sim/guarded_run.h"
#include "server/sim/list_memory.h"
#include "server/sim/near_pairs.h"

namespace clothlab::session {

class Stepper {
 public:
  /// Loads `document`, which plays at once. The first frame has the number `last_frame` + 1.
  static Result<std::unique_ptr<Stepper>> create(scene::Document document, Exchange& exchange,
                                                 const Limits& limits, std::optional<int> gpu = std::nullopt,
                                                 std::uint32_t last_frame = 0,
                                                 std::shared_ptr<MeshShelf> meshes = nullptr);

  /// The name of the device (GL_RENDERER).
  const std::string& renderer() const { return engine_->context->device().name; }
  /// True if the device was reset: nothing here works any more.
  bool lost() const { return engine_->context->lost(); }

  /// Restores a saved session of this document. Error: the saved state has another number of vertices.
  clothlab::Status bring_back(const Saved& saved);
  /// The state from which the session can be restored. Waits for the GPU.
  Saved saved();
  /// Rises with every change of what `saved` returns.
  std::uint64_t version() const { return state_version_ + revision_; }

  /// Handles commands that wait, then does the work that is due. Returns the time of the next turn, unless a
  /// command comes before.
  Clock::time_point turn();
  /// Called between the pieces of what this thread does. Throws GivenUp if a change of the scene is being
  /// built that nobody wants any more.
  void look_up();

 private:
  struct Waiting {  // a sim.step that is not finished
    Ticket ticket;
    std::uint64_t until_step = 0;
  };
  struct Branch {  // of the timeline: what came after a step
    std::uint64_t after = 0, newest = 0;
    Timeline timeline;  ///< with it
  };
  struct Replay {  // on the way from a kept state to a step
    std::uint64_t step = 0;
    std::deque<Timeline::Event> events;
    Ticket ticket;
  };
  using Answer = std::variant<json, JsonText, Refusal>;

  Stepper(scene::Document document, Exchange& exchange, const Limits& limits, std::optional<int> gpu,
          std::shared_ptr<MeshShelf> meshes)
      : meshes_(std::move(meshes)),
        document_(std::move(document)),
        exchange_(exchange),
        limits_(limits),
        gpu_(gpu),
        list_memory_(std::make_shared<sim::ListMemory>(limits.memory)),
        history_(limits.past_bytes / 4) {
    document_.assets = meshes_;
  }
  sim::Simulation& simulation() const { return *engine_->simulation; }
  const scene::Scene& scene() const {
    return simulation().scene();
  }  ///< the scene as it is stepped: its method is never "auto"
  FrameMaker& frames() const { return *engine_->frames; }
  /// The scene to step for a document (see Automatic). Error: it is over the limits, or cannot be built.
  Result<scene::Scene> prepare(const scene::Document& document);
  /// Reserves the memory of a scene that is to be built, beside the present one's. Error: there is not so
  /// much.
  Result<MemoryBudget::Reservation> place_for(const scene::Scene& scene) const;

  // In stepper_commands.cpp. Each `perform` answers its ticket if that has an id.
  void handle_commands();
  void handle(Command& command);
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
  // In stepper_hands.cpp.
  void perform(GrabStart& start, const Ticket& ticket);
  void perform(GrabMove& move, const Ticket& ticket);
  void perform(GrabEnd& end, const Ticket& ticket);
  void refuse_grab(const Ticket& ticket, Refusal refusal);
  clothlab::Status hands_changed();
  void end_hands();
  // In stepper_recording.cpp.
  void perform(RecordStart& start, const Ticket& ticket);
  void perform(RecordStop&, const Ticket& ticket);
  void record_mesh();
  void record_change(json change);
  void follow_recording();
  // In stepper_inspect.cpp.
  void perform(InspectSprings& springs, const Ticket& ticket);
  void perform(InspectElements& elements, const Ticket& ticket);
  void perform(InspectVertices& vertices, const Ticket& ticket);
  void perform(InspectContacts& contacts, const Ticket& ticket);
  json contacts_told(std::size_t most) const;
  // In stepper_meshes.cpp.
  void perform(UploadMesh& upload, const Ticket& ticket);
  clothlab::Status use_again(const std::string& mesh, const Ticket& ticket);
  void keep_mesh(const std::string& name);
  std::set<std::string> meshes_named() const;
  // In stepper_scene.cpp.
  void perform(GetScene&, const Ticket& ticket);
  void perform(LoadScene& load, const Ticket& ticket);
  void perform(PatchScene& patch, const Ticket& ticket);
  void perform(TravelHistory& travel, const Ticket& ticket);
  bool outdated(std::optional<std::uint64_t> revision, const Ticket& ticket);
  Result<std::optional<json>> keep_stable(json& patch, scene::Document& document) const;
  clothlab::Status check_size(const scene::Document& document) const;
  /// What `build` makes, or why it was given up: then nothing has changed.
  template <class Build>
  auto built(const Build& build) -> decltype(build()) {
    const MayGiveUp may;
    try {
      return build();
    } catch (const GivenUp&) {
      return *under_way_.given_up;
    }
  }
  Refusal refused(Error error) const;
  Result<sim::ChangeDepth> travelled(const History::Change& change, Direction direction);
  Result<sim::ChangeDepth> bring(scene::Document document, bool anew);
  Result<sim::ChangeDepth> engine_for(const scene::Document& document, bool anew);
  void remember(History::Change change);
  void announce_history();
  void tell_if_rebuilt(sim::ChangeDepth depth);
  Result<sim::ChangeDepth> change(const scene::Scene& scene);
  Result<sim::ChangeDepth> change_engine(const scene::Scene& scene);
  Result<sim::ChangeDepth> change_here(const scene::Scene& scene);
  Result<sim::ChangeDepth> move_to(const scene::Scene& scene);
  bool returns_to_left_engine(const scene::Scene& scene) const;
  void settle_in(std::unique_ptr<Engine> next);
  void free_left_engine();
  void adopt(scene::Document document, sim::ChangeDepth depth);
  void take_over(scene::Document document, sim::ChangeDepth depth);
  void restart();
  void state_replaced();
  void announce_scene(std::optional<json> patch, std::uint64_t by);
  const JsonText& scene_text();
  // In stepper_timeline.cpp.
  void perform(GetTimeline&, const Ticket& ticket);
  void perform(ResumeAt& resume, const Ticket& ticket);
  void begin_timeline();
  std::uint64_t next_step_to_begin() const;
  void scene_on_timeline();
  void hands_on_timeline();
  void bound_timeline();
  void timeline_went_back();
  json timeline_told();
  void forget_timeline();
  std::size_t most_logged() const;
  bool timeline_awaits_step() const;
  Refusal no_timeline() const;
  clothlab::Status begin_replay(std::uint64_t step, const Ticket& ticket);
  Branch exchange_branch(std::uint64_t after, Timeline other);
  void forget_branch();
  std::uint64_t replay_changes();
  void end_replay();
  // In stepper_commands.cpp.
  void reply(const Ticket& ticket, Answer answer);
  json where_we_are() const;
  static Refusal diverged_refusal();
  void announce_parts();
  void announce_solver();

  // In stepper_warnings.cpp.
  void warn_if_slow(Clock::time_point now);
  void warn_if_crowded();
  void warn_if_lists_stay();
  void warn_if_not_taken();
  void warn_if_forced();
  void warn_if_unconverged();
  void warn_if_unsolved();
  void warn_if_thin();
  void warn_if_slipping();
  void warn_if_near();
  void tell_if_led_out();
  void warn_of_meshes();
  // In stepper.cpp.
  void advance(Clock::time_point now, std::uint32_t others);
  std::uint32_t queue_piece(std::uint32_t others);
  void want_steps(Clock::time_point now, bool run);
  void note_finished(Clock::time_point now);
  void finish_waiting(bool all);
  void follow_diagnostics(Clock::time_point now);
  void request_diagnosis(Clock::time_point now);
  void judge_scene();
  void accept(sim::GuardedRun::Verdict verdict);
  void fall_asleep();
  void wake_up();
  void diverge();
  void go_on();
  void publish_status(Clock::time_point now);
  void follow_step_limit();
  bool suspended(Clock::time_point now) const;
  bool running(Clock::time_point now) const { return run_.steps() && !suspended(now); }
  Clock::time_point next_turn(Clock::time_point now) const;

  std::shared_ptr<MeshShelf> meshes_;
  scene::Document document_;  ///< as clients see it: its method may be "auto"
  Exchange& exchange_;
  Limits limits_;
  std::optional<int> gpu_;
  std::shared_ptr<sim::ListMemory> list_memory_;
  MemoryBudget::Reservation past_memory_{};  ///< of what can be gone back to
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<Engine> left_;  ///< by a change since the last step; a change back returns to it
  PieceSize piece_size_;
  bool compiled_ = false;  ///< a step has ended since the scene was built or changed
  RealTime real_time_;
  StepLimit step_limit_;
  Rest rest_;
  Automatic automatic_;
  Hands hands_;
  History history_;
  json history_told_;  ///< what clients know of it

  Timeline timeline_;
  std::optional<Replay> replay_;
  std::optional<Branch> branch_left_;  ///< by the last ResumeAt; its states are set aside in KeptStates
  Recorder recorder_{exchange_, static_cast<std::size_t>(limits_.recording_bytes), limits_.memory};
  std::uint32_t recorded_revision_ = 0;   ///< of the mesh that the recording has
  std::vector<Ticket> ending_recording_;  ///< requests record.stop that wait for the end of the recording

  /// What was last read for InspectContacts, and told of it.
  struct ContactsTold {
    bool read = false;
    sim::NearPairs near{};  ///< max_inspected_contacts at most, of `total`
    std::size_t total = 0;
    std::uint32_t topology_revision = 0;
    std::uint64_t revision = 0, state_version = 0;
    double time = 0;  ///< [s]
    std::uint64_t step = 0;
    Clock::time_point at{};
    JsonText text{};  ///< the last answer, to `most`; null: none yet
    std::size_t most = 0;
  } contacts_;
  JsonText scene_text_;  ///< see scene_text

  /// The command under way.
  struct UnderWay {
    Ticket ticket{};
    bool an_undo = false;
    Clock::time_point begun{}, next_look{};
    std::string name{};               ///< what the history will call the change
    std::optional<Error> given_up{};  ///< why it was
  } under_way_;
  /// The scene.undo that has given up a change while it was built, and what that change was called.
  std::optional<std::pair<Ticket, std::string>> undone_while_built_;
  std::uint64_t scene_text_revision_ = 0;

  std::uint64_t revision_ = 1;
  std::uint32_t topology_revision_ = 0;
  RunState run_;
  bool was_running_ = false;
  std::vector<Waiting> waiting_;
  int watchers_ = 0;
  Clock::time_point last_watched_{};

  std::optional<sim::GuardedRun> guard_;  ///< set as soon as `engine_` is set
  std::uint64_t state_version_ = 1,
                diagnosed_version_ = 0;  ///< the state version that was diagnosed last
  Clock::time_point next_status_{}, next_diagnosis_{};
  Clock::time_point slow_since_{};
  bool slow_announced_ = false, crowded_announced_ = false, forced_announced_ = false,
       not_taken_announced_ = false, unconverged_announced_ = false, unsolved_announced_ = false;
  bool lists_stay_announced_ = false;
  bool layers_may_pass_ = false;         ///< layers of cloth can pass through each other
  bool solids_may_slip_ = false;         ///< solids can pass through triangles of cloth
  std::string near_start_;               ///< model::near_start_warning of the present cloth
  std::string led_out_;                  ///< model::dressed_note of the present cloth
  std::vector<std::string> mesh_notes_;  ///< told of the present scene (scene::mesh_notes)
};

}  // namespace clothlab::session
