#include <algorithm>
#include <new>
#include <utility>

#include "server/base/text.h"
#include "server/model/constraint_gains.h"
#include "server/model/thickness.h"
#include "server/scene/named_fabric.h"
#include "server/session/stepper.h"

namespace clothlab::session {

using std::chrono::milliseconds;

/// While a replay is under way, commands wait.
void Stepper::handle_commands() {
  const Clock::time_point begun = Clock::now();
  Clock::time_point now = begun;
  for (int handled = 0; handled < commands_a_turn && !replay_ && now - begun < longest_commands; ++handled) {
    std::optional<Command> command = exchange_.next_command();
    if (!command) return;
    under_way_ = {};
    under_way_.ticket = command->ticket;
    under_way_.begun = now;
    const auto* travel = std::get_if<TravelHistory>(&command->what);
    under_way_.an_undo = travel && travel->direction == Direction::undo;
    handle(*command);
    now = Clock::now();
    exchange_.spent(now - under_way_.begun);
  }
}

void Stepper::look_up() {
  constexpr milliseconds between_looks{20};
  const Clock::time_point now = Clock::now();
  if (!may_give_up() || now < under_way_.next_look) return;
  under_way_.next_look = now + between_looks;
  const std::optional<Exchange::GiveUp> wish =
      exchange_.to_give_up(under_way_.ticket.asker, under_way_.an_undo);
  if (!wish) return;
  using Why = Exchange::GiveUp::Why;
  const Clock::duration worked = now - under_way_.begun;
  if (wish->why != Why::stopping && worked < limits_.kept_building) return;
  const char* why = wish->why == Why::stopping ? "the server stops"
                    : wish->why == Why::left   ? "who asked for it has left"
                    : wish->why == Why::undone ? "it was undone before it was there"
                                               : "another scene is loaded";
  const std::string name = under_way_.name.empty() ? "a change" : under_way_.name;
  under_way_.given_up = Error{"",
                              formatted("%s was given up after %.1f s of building, as %s", name.c_str(),
                                        std::chrono::duration<double>(worked).count(), why),
                              "send it again, and wait until it is answered"};
  if (wish->why == Why::undone) undone_while_built_ = {wish->by, name};
  if (wish->why == Why::left) exchange_.emit(Notice{"info", under_way_.given_up->what});
  throw GivenUp();
}

void Stepper::handle(Command& command) {
  const Exchange::Batch batch(exchange_);
  try {
    std::visit([&](auto& what) { perform(what, command.ticket); }, command.what);
  } catch (const std::bad_alloc&) {
    // All new objects have been freed, and the old ones are unchanged.
    const Error error{"session", "there is not enough memory for that", "a smaller scene, or fewer sessions"};
    if (command.ticket.id)
      reply(command.ticket, Refusal{Refusal::Reason::failed, error});
    else if (const auto* what = std::get_if<Export>(&command.what))
      exchange_.emit(Captured{command.ticket.asker, *what, error});
  }
}

void Stepper::reply(const Ticket& ticket, Answer answer) {
  if (!ticket.id) return;
  if (auto* refusal = std::get_if<Refusal>(&answer))
    return exchange_.emit(Reply{ticket, std::move(*refusal)});
  const auto* text = std::get_if<JsonText>(&answer);
  exchange_.emit(Reply{ticket, text ? *text : text_of(std::get<json>(answer))});
}

json Stepper::where_we_are() const {
  return {{"playing", run_.plays()}, {"time", simulation().time()}, {"step", simulation().step_index()}};
}

Refusal Stepper::diverged_refusal() {
  return {Refusal::Reason::diverged,
          {"", "the simulation has diverged",
           "send the remedy's patch or another, or use sim.reset or scene.load"}};
}

void Stepper::perform(Play&, const Ticket& ticket) {
  finish_waiting(true);
  wake_up();
  if (!run_.play()) return reply(ticket, diverged_refusal());
  ++state_version_;
  reply(ticket, where_we_are());
}

void Stepper::perform(Pause&, const Ticket& ticket) {
  finish_waiting(true);
  wake_up();
  ++state_version_;
  run_.pause();
  reply(ticket, where_we_are());
}

void Stepper::perform(Step& step, const Ticket& ticket) {
  wake_up();
  if (!run_.step_by_hand()) return reply(ticket, diverged_refusal());
  const std::uint64_t from = waiting_.empty() ? simulation().step_index() : waiting_.back().until_step;
  waiting_.push_back({ticket, from + step.steps});
}

void Stepper::perform(Reset&, const Ticket& ticket) {
  restart();
  record_change({{"reset", true}, {"by", ticket.asker}});
  reply(ticket, where_we_are());
}

void Stepper::perform(Speed& speed, const Ticket& ticket) {
  wake_up();
  ++state_version_;
  real_time_.set_speed(speed.factor);
  real_time_.restart(Clock::now());
  reply(ticket, json{{"factor", speed.factor}});
}

void Stepper::perform(Demand& demand, const Ticket&) {
  frames().demand(demand, Clock::now());
}

void Stepper::perform(Watchers& watchers, const Ticket&) {
  watchers_ = watchers.count;
  last_watched_ = Clock::now();
}

void Stepper::perform(ReachScene& reach, const Ticket&) {
  exchange_.emit(SceneReached{reach.job});
}

void Stepper::perform(Hold& hold, const Ticket&) {
  if (run_.hold()) {
    simulation().finish();  // otherwise work that is already queued would run beside the job
    exchange_.emit(Notice{"info", "paused while the lab measures"});
  }
  exchange_.emit(Held{hold.job});
}

void Stepper::perform(Release&, const Ticket&) {
  run_.release();
}

void Stepper::perform(Export& what, const Ticket& ticket) {
  last_watched_ = Clock::now();
  exchange_.emit(Captured{ticket.asker, what,
                          Moment{std::make_shared<const scene::Document>(document_), simulation().time(),
                                 simulation().read_state().position, simulation().colliders_now()}});
}

// The document keeps the method "auto"; sim.status shows the settings that are stepped with.
void Stepper::perform(Chosen& chosen, const Ticket&) {
  automatic_.take(*chosen.measured, chosen.choice);
  if (!document_.scene.solver.automatic) return;
  const Result<scene::Scene> scene = automatic_.settle(document_, Clock::now());
  if (!scene) return;
  const Result<sim::ChangeDepth> depth = change(*scene);
  if (!depth) return exchange_.emit(Notice{"warning", "method auto: " + depth.error().text()});
  take_over(document_, *depth);
  if (!chosen.choice)
    exchange_.emit(Notice{"warning", "method auto: nothing better than a stable step can be chosen: " +
                                         chosen.choice.error().text()});
  else
    exchange_.emit(Notice{"info", "method auto: " + chosen.choice->why});
}

void Stepper::announce_parts() {
  std::vector<sim::Simulation::Part> parts = simulation().parts();
  for (sim::Simulation::Part& part : parts)
    if (run_.at_rest() && part.skipped.empty()) part.skipped = "asleep: the cloth is at rest";
  exchange_.emit(PartsChanged{std::move(parts)});
}

// A stiffness in N/m means the same in every method except PBD. For PBD clients also get, for each kind of
// spring, the share of a spring's stretch that one visit removes.
void Stepper::announce_solver() {
  json shares = nullptr;
  if (scene().solver.method == scene::Method::pbd) {
    shares = json::array();
    for (const model::PbdStiffness& of : model::pbd_stiffness(simulation().model(), scene())) {
      const auto share = [&](model::SpringKind kind) {
        const std::optional<double>& value = of[static_cast<std::size_t>(kind)];
        return value ? json(*value) : json(nullptr);
      };
      shares.push_back({{"structural", share(model::SpringKind::structural)},
                        {"shear", share(model::SpringKind::shear)},
                        {"bend", share(model::SpringKind::bend)}});
    }
  }
  json thickness = nullptr;
  if (scene().collides(scene::ContactKind::points))
    thickness = model::least_safe_thickness(simulation().model());
  exchange_.emit(SolverChanged{{{"pbd_stiffness", shares},
                                {"auto", automatic_.facts()},
                                {"thickness_that_holds", thickness},
                                {"from_fabrics", scene::left_to_fabrics(document_)}}});
}

}  // namespace clothlab::session
