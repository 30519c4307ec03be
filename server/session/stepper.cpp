#include "server/session/stepper.h"

#include <algorithm>
#include <new>
#include <utility>

#include "server/gl/buffer.h"
#include "server/model/size.h"
#include "server/model/thickness.h"
#include "server/scene/method.h"
#include "server/session/fault.h"
#include "server/sim/memory.h"
#include "server/sim/slipping.h"

namespace clothlab::session {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::microseconds;
using std::chrono::milliseconds;

Result<std::unique_ptr<Stepper>> Stepper::create(scene::Document document, Exchange& exchange,
                                                 const Limits& limits, std::optional<int> gpu,
                                                 std::uint32_t last_frame,
                                                 std::shared_ptr<MeshShelf> meshes) {
  if (!meshes) meshes = std::make_shared<MeshShelf>(document.assets);
  auto stepper =
      std::unique_ptr<Stepper>(new Stepper(std::move(document), exchange, limits, gpu, std::move(meshes)));
  const Result<scene::Scene> scene = stepper->prepare(stepper->document_);
  if (!scene) return scene.error();
  Result<MemoryBudget::Reservation> past =
      MemoryBudget::reserve(limits.memory, MemoryBudget::Use::timelines, limits.past_bytes);
  if (!past) return past.error();
  stepper->past_memory_ = std::move(*past);
  Result<MemoryBudget::Reservation> place = stepper->place_for(*scene);
  if (!place) return place.error();
  sim::ListMemory::of_thread() = stepper->list_memory_;
  Result<std::unique_ptr<Engine>> engine = Engine::create(*scene, exchange, {gpu, last_frame});
  if (!engine) return engine.error();
  stepper->engine_ = std::move(*engine);
  stepper->engine_->memory = std::move(*place);
  stepper->guard_.emplace(stepper->simulation());
  stepper->last_watched_ = stepper->next_status_ = Clock::now();
  stepper->announce_scene(std::nullopt, 0);
  stepper->announce_history();
  stepper->announce_parts();
  stepper->announce_solver();
  stepper->layers_may_pass_ = !model::thickness_warning(stepper->simulation().model(), *scene).empty();
  stepper->solids_may_slip_ = !sim::slipping_warning(*scene, stepper->simulation().model()).empty();
  stepper->step_limit_.set_scene(stepper->simulation().model(), *scene);
  stepper->rest_.follow(*scene, stepper->simulation().model());
  stepper->guard_->start(stepper->step_limit_.dt_limit());
  stepper->judge_scene();
  stepper->begin_timeline();
  return stepper;
}

clothlab::Status Stepper::bring_back(const Saved& saved) {
  if (saved.state.position.size() != simulation().model().vertex_count())
    return Error{"saved session",
                 std::to_string(saved.state.position.size()) + " vertices of a scene that has " +
                     std::to_string(simulation().model().vertex_count()),
                 "use a session file that this version of the program wrote"};
  simulation().restore(saved.state, saved.time, saved.step);
  if (!saved.playing) run_.pause();
  real_time_.set_speed(std::clamp(saved.speed, min_speed, max_speed));
  state_replaced();
  guard_->start(step_limit_.dt_limit());
  revision_ = saved.revision;
  announce_scene(std::nullopt, 0);
  return ok();
}

Saved Stepper::saved() {
  return {document_.value,          revision_,           run_.would_play(),
          real_time_.speed(),       simulation().time(), simulation().step_index(),
          simulation().read_state()};
}

clothlab::Status Stepper::check_size(const scene::Document& document) const {
  return model::check_size(model::size_of(document.scene), static_cast<std::size_t>(limits_.vertices),
                           static_cast<std::size_t>(limits_.springs));
}

Result<scene::Scene> Stepper::prepare(const scene::Document& document) {
  if (clothlab::Status fits = scene::check_bytes(document.value); !fits) return fits.error();
  if (clothlab::Status fits = check_size(document); !fits) return fits.error();
  if (fault_due(Fault::change_fails, "", engine_ ? simulation().step_index() : 0)) throw std::bad_alloc();
  return automatic_.settle(document, Clock::now());
}

Result<MemoryBudget::Reservation> Stepper::place_for(const scene::Scene& scene) const {
  return sim::reserve_memory(limits_.memory, scene);
}

Clock::time_point Stepper::turn() {
  exchange_.beat();
  handle_commands();
  const Clock::time_point now = Clock::now();
  if (watchers_ > 0) last_watched_ = now;
  if (replay_) {
    advance(now, 0);
    return replay_ ? Clock::now() : next_turn(Clock::now());
  }
  {
    // Not on a GPU, whose driver shares it out; nor in the first step after a change, in which software
    // OpenGL may compile kernels for seconds.
    std::optional<gl::DisplayTurn> turn;
    if (engine_->place && compiled_) turn.emplace(engine_->place->threads());
    frames().make_urgent(simulation(), now);
    advance(now, turn ? turn->others() : 0);
    frames().make_urgent(simulation(), now);
    frames().make_due(simulation(), Clock::now());
    frames().poll();
  }
  follow_recording();
  follow_diagnostics(Clock::now());
  return next_turn(Clock::now());
}

void Stepper::advance(Clock::time_point now, std::uint32_t others) {
  note_finished(now);
  const bool run = running(now);
  if (run && !was_running_) real_time_.restart(now);
  was_running_ = run;
  if (engine_->backlog.full()) return;
  want_steps(now, run);
  if (replay_ && simulation().step_index() == replay_->step) return end_replay();
  if (simulation().steps_to_do() == 0) return;
  free_left_engine();
  const std::uint32_t steps = queue_piece(others);
  note_finished(Clock::now());
  if (steps == 0) return;
  ++state_version_;
  exchange_.count_steps(steps);
  frames().state_changed();
  if (waiting_.empty()) return;
  finish_waiting(false);
  if (waiting_.empty()) frames().state_changed_now();
}

/// Queues a piece of the steps to do, while `others` wait to compute. Returns the number of steps that it
/// ends.
std::uint32_t Stepper::queue_piece(std::uint32_t others) {
  const std::uint64_t before = simulation().step_index();
  const Clock::time_point begun = Clock::now();
  sim::Pace pace = piece_size_.pace(begun, others);
  simulation().resume(pace);
  const auto steps = static_cast<std::uint32_t>(simulation().step_index() - before);
  engine_->backlog.push({steps, pace.passed, begun});
  if (steps > 0) compiled_ = true;
  return steps;
}

void Stepper::want_steps(Clock::time_point now, bool run) {
  if (replay_)
    simulation().set_steps_to_do(static_cast<std::uint32_t>(replay_changes()));
  else if (!waiting_.empty())
    // No further than the step at which the next sim.step ends, as its answer reports that step.
    simulation().set_steps_to_do(
        static_cast<std::uint32_t>(std::min<std::uint64_t>(
            waiting_.front().until_step - simulation().step_index(), real_time_.affordable())),
        &engine_->step_timer);
  else if (!run)
    simulation().set_steps_to_do(0);
  else if (simulation().steps_to_do() == 0)
    simulation().set_steps_to_do(real_time_.due(now, scene().solver.dt), &engine_->step_timer);
}

void Stepper::note_finished(Clock::time_point now) {
  engine_->backlog.poll(now, [&](const GpuBacklog::Piece& piece, double seconds) {
    real_time_.add_work_time(piece.steps, seconds);
    piece_size_.add_piece_time(piece.places, seconds);
  });
}

void Stepper::finish_waiting(bool all) {
  const auto done = [&](const Waiting& waiting) {
    if (!all && waiting.until_step > simulation().step_index()) return false;
    if (run_.diverged())
      reply(waiting.ticket, diverged_refusal());
    else
      reply(waiting.ticket, where_we_are());
    return true;
  };
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(), done), waiting_.end());
}

void Stepper::follow_diagnostics(Clock::time_point now) {
  while (const std::optional<sim::GuardedRun::Verdict> verdict = guard_->poll_verdict()) {
    next_diagnosis_ = now + period(diagnosis_rate);
    accept(*verdict);
    const sim::Diagnostics& arrived = guard_->state();
    if (running(now) && hands_.empty() &&
        rest_.look(arrived.time, arrived.max_speed, [&] { return simulation().read_state().position; }))
      fall_asleep();
  }
  request_diagnosis(now);
  if (now < next_status_) return;
  // While nothing is stepped, a status waits for the diagnostics of the present state.
  if (!running(now) && waiting_.empty() &&
      (guard_->verdict_requested() || diagnosed_version_ != state_version_))
    return;
  next_status_ = std::max(next_status_ + period(status_rate), now);
  publish_status(now);
}

/// A blow-up is looked for as `run` does, by steps; the other diagnoses are to be seen.
void Stepper::judge_scene() {
  guard_->judge_every(sim::judged_every(scene(), simulation().model()));
}

// A state that stands still is diagnosed once.
void Stepper::request_diagnosis(Clock::time_point now) {
  if (guard_->verdict_requested() || diagnosed_version_ == state_version_ || now < next_diagnosis_) return;
  engine_->diagnosis_timer.begin();
  guard_->request_verdict();
  engine_->diagnosis_timer.stage("diagnose");
  engine_->diagnosis_timer.end();
  diagnosed_version_ = state_version_;
  next_diagnosis_ = std::max(next_diagnosis_ + period(diagnosis_rate), now);
}

void Stepper::accept(sim::GuardedRun::Verdict verdict) {
  if (verdict == sim::GuardedRun::Verdict::blown_up) return diverge();
  warn_if_crowded();
  warn_if_lists_stay();
  warn_if_not_taken();
  warn_if_forced();
  warn_if_unconverged();
  warn_if_unsolved();
}

void Stepper::fall_asleep() {
  if (!run_.fall_asleep()) return;
  frames().asleep(true);
  announce_parts();
}

void Stepper::wake_up() {
  rest_.disturb();
  if (!run_.wake()) return;
  frames().asleep(false);
  announce_parts();
}

void Stepper::diverge() {
  const scene::Solver& solver = scene().solver;
  auto [reason, remedy, energy] = guard_->go_back();
  timeline_went_back();
  json change{{"dt", remedy.dt}};
  if (remedy.method || solver.automatic)
    change["method"] = scene::name(remedy.method.value_or(solver.method));
  ++state_version_;
  end_hands();
  guard_->start(step_limit_.dt_limit());
  wake_up();
  run_.diverge();
  finish_waiting(true);
  frames().diverge();
  exchange_.emit(Diverged{std::move(reason), std::move(remedy.text), {{"solver", change}}, energy});
}

// After a blow-up and a change of scene the session goes on from the last good state, playing or paused as
// before.
void Stepper::go_on() {
  if (!run_.go_on()) return;
  real_time_.restart(Clock::now());
  frames().go_on();
}

void Stepper::publish_status(Clock::time_point now) {
  if (automatic_.wants_choice(now)) exchange_.emit(ChoiceWanted{});
  if (was_running_) real_time_.sample(now, simulation().time());
  Status status;
  status.run = run_;
  status.speed = real_time_.speed();
  status.real_time_factor = was_running_ ? real_time_.factor() : 0;
  status.paced = was_running_ && real_time_.sampled();
  status.memory_bytes = gl::buffer_bytes();
  follow_step_limit();
  status.dt_limit = step_limit_.dt_limit();
  status.margin = step_limit_.margin();
  status.diagnostics = guard_->state();
  status.convergence = simulation().convergence();
  status.hands = hands_.told();
  // The timers measure again only after their times are taken, which gives a few samples a second.
  engine_->step_timer.poll(status.pass_times);
  engine_->diagnosis_timer.poll(status.pass_times);
  frames().poll_times(status.pass_times);
  exchange_.publish(status);
  warn_if_slow(now);
}

void Stepper::follow_step_limit() {
  if (step_limit_.poll()) guard_->set_dt_limit(step_limit_.dt_limit());
  if (std::optional<std::string> warning = step_limit_.take_warning())
    exchange_.emit(Notice{"warning", std::move(*warning)});
}

bool Stepper::suspended(Clock::time_point now) const {
  return watchers_ == 0 && duration<double>(now - last_watched_).count() > limits_.unwatched_seconds;
}

Clock::time_point Stepper::next_turn(Clock::time_point now) const {
  if ((simulation().steps_to_do() > 0 || !waiting_.empty()) && !engine_->backlog.full()) return now;
  if (frames().urgent() || frames().in_flight() || !ending_recording_.empty() ||
      guard_->verdict_requested() || !engine_->backlog.empty())
    return now + microseconds(500);
  if (!running(now)) return suspended(now) ? now + milliseconds(250) : std::max(next_status_, now);
  if (real_time_.behind(scene().solver.dt)) return now;
  return std::min({now + milliseconds(10), next_status_, std::max(frames().next_due(), now)});
}

}  // namespace clothlab::session
