// record.start and record.stop, as a session's thread carries them out.
#include <utility>

#include "server/session/stepper.h"

namespace clothlab::session {

void Stepper::perform(RecordStart& start, const Ticket& ticket) {
  if (recorder_.busy())
    return reply(ticket, Refusal{Refusal::Reason::over_limit,
                                 {"", "this session is being recorded already", "call record.stop first"}});
  if (const clothlab::Status begun = recorder_.start(start.rate, document_.value, document_.scene.name,
                                                     simulation().model().vertex_count());
      !begun)
    return reply(ticket, Refusal{Refusal::Reason::over_limit, begun.error()});
  record_mesh();
  frames().record(start.rate, Clock::now());
  reply(ticket, facts_of(exchange_.recording()));
}

void Stepper::perform(RecordStop&, const Ticket& ticket) {
  if (!recorder_.recording())
    return reply(ticket, invalid_value({"", "nothing is being recorded", "call record.start first"}));
  frames().record(0, Clock::now());
  recorder_.stop();
  ending_recording_.push_back(ticket);
}

void Stepper::record_mesh() {
  recorded_revision_ = simulation().topology_revision();
  recorder_.mesh(std::make_shared<const model::Model>(simulation().model()),
                 std::make_shared<const scene::Scene>(scene()), recorded_revision_);
}

/// `change` has what changed the scene, and by whom.
void Stepper::record_change(json change) {
  if (!recorder_.recording()) return;
  change["step"] = simulation().step_index();
  change["time"] = simulation().time();
  recorder_.change(std::move(change));
  if (simulation().topology_revision() != recorded_revision_) record_mesh();
}

void Stepper::follow_recording() {
  for (stream::SharedMessage& frame : frames().take_recorded())
    if (recorder_.recording()) recorder_.frame(std::move(frame));
  const std::optional<Recorder::End> end = recorder_.poll();
  if (!end) return;
  frames().record(0, Clock::now());
  if (*end == Recorder::End::limit)
    exchange_.emit(Notice{"warning",
                          "the recording has as many bytes as it may have (--max-recording-bytes) and "
                          "has ended; it is kept until the next one"});
  if (*end == Recorder::End::memory)
    exchange_.emit(Notice{"warning",
                          "the recording has ended, as the server has no more memory for recordings "
                          "(--max-memory); it is kept until the next one"});
  if (*end == Recorder::End::failed)
    exchange_.emit(Notice{"error", "the recording was given up: there was not enough memory"});
  for (const Ticket& ticket : std::exchange(ending_recording_, {}))
    reply(ticket, facts_of(exchange_.recording()));
}

}  // namespace clothlab::session
