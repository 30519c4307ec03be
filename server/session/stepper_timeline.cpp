// The session's timeline: the states and changes that it keeps, and how it goes on from an earlier step.
#include <new>
#include <utility>

#include "server/base/text.h"
#include "server/session/stepper.h"
#include "server/sim/kept_states.h"

namespace clothlab::session {

/// The run begins, or begins anew: nothing before the present state can be reached again.
void Stepper::begin_timeline() {
  simulation().kept().clear();
  branch_left_.reset();
  simulation().kept().most = limits_.past_bytes / 2;
  timeline_.begin(document_, scene(), simulation().step_index());
  try {
    simulation().keep_state();
    simulation().kept().every = Timeline::interval(scene(), limits_.kept_every);
  } catch (const std::bad_alloc&) {  // without memory for one state the session runs without a timeline
    simulation().kept().every = 0;
  }
}

/// The present step cannot be reached again, as what changed the run since the step before takes too much.
/// Its cloth can hardly be kept either: what methods remember of it may still be put back
/// (note_before_changes of the simulation), by a change that takes these back. So the timeline begins anew
/// where the next step ends.
void Stepper::forget_timeline() {
  simulation().kept().clear();
  branch_left_.reset();
  simulation().kept().after_step = true;
  timeline_.begin(document_, scene(), next_step_to_begin(), hands_.for_simulation());
  if (timeline_.bytes() <= most_logged()) return;
  simulation().kept().every = 0;  // not even the present document can be kept
  simulation().kept().after_step = false;
  timeline_.clear();
}

Refusal Stepper::no_timeline() const {
  if (simulation().kept().after_step)
    return {Refusal::Reason::failed,
            {"", "what changed the scene since the last step takes more than is kept of it",
             "go on: the timeline begins again with the next step"}};
  return {Refusal::Reason::failed,
          {"", "there is no memory to keep earlier states of this scene", "a smaller scene"}};
}

/// What changes nothing of the simulation comes between two steps, even if it is told of within one.
std::uint64_t Stepper::next_step_to_begin() const {
  return simulation().step_index() + (simulation().in_step() ? 1u : 0u);
}

void Stepper::scene_on_timeline() {
  if (simulation().kept().count() == 0 && !timeline_awaits_step()) return;
  simulation().kept().every = Timeline::interval(scene(), limits_.kept_every);
  if (timeline_awaits_step()) return forget_timeline();
  timeline_.add_scene(next_step_to_begin(), document_, scene(), false);
  bound_timeline();
}

void Stepper::hands_on_timeline() {
  if (timeline_awaits_step()) return forget_timeline();
  if (simulation().kept().count() == 0) return;
  timeline_.add_hands(next_step_to_begin(), hands_.for_simulation());
  bound_timeline();
}

std::size_t Stepper::most_logged() const {
  return limits_.past_bytes / 4;
}

bool Stepper::timeline_awaits_step() const {
  return simulation().kept().count() == 0 && simulation().kept().after_step;
}

void Stepper::bound_timeline() {
  sim::KeptStates& kept = simulation().kept();
  if (kept.count() == 0) return;  // the cloth is new, and the timeline is about to begin
  timeline_.forget_before(kept.oldest()->step);
  while (timeline_.bytes() > most_logged() && kept.count() > 1) {
    kept.drop_oldest();
    timeline_.forget_before(kept.oldest()->step);
  }
  if (timeline_.bytes() > most_logged()) forget_timeline();
}

/// After a blow-up the run goes on from the last good state, with the scene as it is now.
void Stepper::timeline_went_back() {
  const std::uint64_t step = simulation().step_index();
  if (branch_left_ && step <= branch_left_->after) forget_branch();
  simulation().kept().drop_after(step);
  if (simulation().kept().count() == 0) return begin_timeline();
  timeline_.cut_after(step);
  simulation().keep_state();
  timeline_.add_scene(step, document_, scene(), true);
}

json Stepper::timeline_told() {
  const sim::KeptStates& kept = simulation().kept();
  return {{"oldest", {{"step", kept.oldest()->step}, {"time", kept.oldest()->time}}},
          {"newest", {{"step", simulation().step_index()}, {"time", simulation().time()}}},
          {"states", kept.count()},
          {"bytes", kept.bytes() + timeline_.bytes()}};
}

void Stepper::perform(GetTimeline&, const Ticket& ticket) {
  bound_timeline();
  if (simulation().kept().count() == 0) return reply(ticket, no_timeline());
  reply(ticket, timeline_told());
}

void Stepper::perform(ResumeAt& resume, const Ticket& ticket) {
  bound_timeline();
  if (simulation().kept().count() == 0) return reply(ticket, no_timeline());
  if (simulation().kept().lost_aside()) forget_branch();
  if (!resume.step && !branch_left_)
    return reply(ticket, Refusal{Refusal::Reason::nothing_there,
                                 {"", "no run that timeline.resume has left is kept", "go on from here"}});
  const std::uint64_t oldest = simulation().kept().oldest()->step, newest = simulation().step_index();
  if (resume.step && (*resume.step < oldest || *resume.step > newest))
    return reply(ticket, invalid_value({"/step", std::to_string(*resume.step),
                                        "a step of the timeline, " + std::to_string(oldest) + " to " +
                                            std::to_string(newest) + "; see timeline.get"}));
  Branch other;
  if (!resume.step) {
    other = std::move(*branch_left_);
  } else {
    simulation().kept().drop_aside();
    other = {simulation().kept().at_or_before(*resume.step)->step, *resume.step, timeline_};
  }
  branch_left_ = exchange_branch(other.after, std::move(other.timeline));
  if (const clothlab::Status begun = begin_replay(other.newest, ticket); !begun) {
    timeline_ = std::move(branch_left_->timeline);
    simulation().kept().exchange_aside(branch_left_->after);
    forget_branch();
    reply(ticket, Refusal{Refusal::Reason::failed, begun.error()});
  }
}

/// Puts the other branch of the timeline, whose states are set aside, in the place of what came after a step,
/// and returns that.
Stepper::Branch Stepper::exchange_branch(std::uint64_t after, Timeline other) {
  simulation().kept().exchange_aside(after);
  return {after, simulation().step_index(), std::exchange(timeline_, std::move(other))};
}

void Stepper::forget_branch() {
  branch_left_.reset();
  simulation().kept().drop_aside();
}

/// On error the run is where it was.
clothlab::Status Stepper::begin_replay(std::uint64_t step, const Ticket& ticket) {
  const sim::KeptState* kept = simulation().kept().at_or_before(step);
  if (!kept) return Error{"", "no state before that step is kept any more", "go on from here"};
  const std::uint64_t from = kept->step;
  const Timeline::Event then = timeline_.in_force(from);
  free_left_engine();
  Result<MemoryBudget::Reservation> place = place_for(*then.scene);
  if (!place) return place.error();
  if (const clothlab::Status back = simulation().go_to_kept(step, *then.scene); !back) return back;
  engine_->memory = std::move(*place);
  (void)simulation().set_hands(*then.hands);  // the kernels are there
  finish_waiting(true);
  wake_up();
  hands_.clear();
  run_.begin_again();
  run_.pause();
  timeline_.cut_after(step);
  replay_.emplace(Replay{step, timeline_.from(from), ticket});
  return ok();
}

/// Makes what changed the run before the next step. Returns the steps that follow until something else does.
std::uint64_t Stepper::replay_changes() {
  std::deque<Timeline::Event>& events = replay_->events;
  for (; !events.empty() && events.front().step <= simulation().step_index(); events.pop_front()) {
    const Timeline::Event& event = events.front();
    if (event.scene) {
      if (const Result<sim::ChangeDepth> done = simulation().change(*event.scene); !done)
        exchange_.emit(Notice{"error", "the timeline cannot be replayed exactly: " + done.error().text()});
      simulation().kept().every = Timeline::interval(scene(), limits_.kept_every);
    }
    if (event.hands) (void)simulation().set_hands(*event.hands);
    if (event.forgets) simulation().forget_carried();
  }
  const std::uint64_t until = events.empty() ? replay_->step : std::min(replay_->step, events.front().step);
  return until - simulation().step_index();
}

void Stepper::end_replay() {
  const Exchange::Batch batch(exchange_);
  const Replay done = std::move(*replay_);
  replay_.reset();
  const Timeline::Event then = timeline_.in_force(done.step + 1);
  const json before = std::exchange(document_.value, json::parse(*then.document));
  document_.scene = *then.scene;
  document_.scene.solver = then.solver;
  if (!then.hands->empty()) {  // who held the cloth then does so no longer
    (void)simulation().set_hands({});
    hands_on_timeline();
  }
  guard_->set_hands(0, 0);
  (void)automatic_.settle(document_, Clock::now());
  ++revision_;
  ++state_version_;
  real_time_.restart(Clock::now());
  frames().restart();
  rest_.follow(scene(), simulation().model());
  step_limit_.set_scene(simulation().model(), scene());
  judge_scene();
  follow_step_limit();
  guard_->start(step_limit_.dt_limit());
  announce_parts();
  announce_solver();
  json answer = where_we_are();
  answer["revision"] = revision_;
  reply(done.ticket, std::move(answer));
  announce_scene(std::nullopt, done.ticket.asker);
  remember(history_.prepare(before, document_.value, formatted("Go on from %.2f s", simulation().time()),
                            done.ticket.asker, Clock::now()));
}

}  // namespace clothlab::session
