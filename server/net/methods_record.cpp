// record.*: a session is recorded, and where the recording is.
#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

Outcome record_start(Client& client, Request& request) {
  Params params(request.params);
  const double rate = params.number("rate", session::min_recording_rate, session::max_recording_rate, 30);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, session::RecordStart{rate});
}

Outcome record_stop(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, session::RecordStop{});
}

/// Answered without the session's thread: frames and bytes are those that are written.
Outcome record_get(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  const session::RecordingFacts facts = client.room()->recording();
  json answer = session::facts_of(facts);
  answer["files"] = nullptr;
  if (facts.file)
    for (const char* ending : {"clothlab", "html", "glb", "usda"})
      answer["files"][ending] = std::string("/api/recording.") + ending + "?session=" + client.room()->name();
  return answer;
}

}  // namespace clothlab::net
