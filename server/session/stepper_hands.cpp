// The commands of hands that hold the cloth: grab.start, grab.move, grab.end.
#include "server/session/stepper.h"

namespace clothlab::session {

namespace {

Refusal no_hold(int hand) {
  return invalid_value({"/hand", std::to_string(hand) + ", which holds nothing",
                        "a hand that holds the cloth: send grab.start first"});
}

}  // namespace

/// Refusals of notifications are told, too: whoever pulls in vain wants to know why.
void Stepper::refuse_grab(const Ticket& ticket, Refusal refusal) {
  exchange_.emit(Reply{ticket, std::move(refusal)});
}

void Stepper::perform(GrabStart& start, const Ticket& ticket) {
  if (run_.diverged()) return refuse_grab(ticket, diverged_refusal());
  if (std::optional<Refusal> refusal = hands_.start(ticket.asker, start, simulation()))
    return refuse_grab(ticket, std::move(*refusal));
  if (const clothlab::Status set = hands_changed(); !set) {
    hands_.end(ticket.asker, start.hand);
    return refuse_grab(ticket, {Refusal::Reason::failed, set.error()});
  }
  reply(ticket, json::object());
}

// A hand that an ending of the cloth has ended, such as a reset, goes on moving for a while: that is no
// mistake.
void Stepper::perform(GrabMove& move, const Ticket& ticket) {
  if (!hands_.move(ticket.asker, move)) return reply(ticket, no_hold(move.hand));
  (void)simulation().set_hands(hands_.for_simulation());  // with the same holds it cannot fail
  hands_on_timeline();
  reply(ticket, json::object());
}

void Stepper::perform(GrabEnd& end, const Ticket& ticket) {
  const bool held = end.hand ? hands_.end(ticket.asker, *end.hand) : hands_.end_all(ticket.asker);
  if (!held) return reply(ticket, no_hold(end.hand.value_or(0)));
  (void)hands_changed();
  reply(ticket, json::object());
}

/// Takes the hands over into the simulation, which then no longer rests.
clothlab::Status Stepper::hands_changed() {
  if (clothlab::Status set = simulation().set_hands(hands_.for_simulation()); !set) return set;
  hands_on_timeline();
  guard_->set_hands(hands_.force(), hands_.reach());
  wake_up();
  return ok();
}

/// The vertices that hands hold are no longer there, or elsewhere.
void Stepper::end_hands() {
  if (hands_.empty()) return;
  hands_.clear();
  (void)hands_changed();
}

}  // namespace clothlab::session
