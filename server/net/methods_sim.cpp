// sim.*: play, pause, step, reset, speed; timeline.*: go on from an earlier step. The session's thread
// carries the requests out in order and answers.
#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

namespace {

template <class What>
Outcome without_parameters(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, What{});
}

}  // namespace

Outcome sim_play(Client& client, Request& request) {
  return without_parameters<session::Play>(client, request);
}
Outcome sim_pause(Client& client, Request& request) {
  return without_parameters<session::Pause>(client, request);
}
Outcome sim_reset(Client& client, Request& request) {
  return without_parameters<session::Reset>(client, request);
}

Outcome sim_step(Client& client, Request& request) {
  Params params(request.params);
  const std::int64_t steps = params.integer("steps", 1, max_steps, 1);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, session::Step{static_cast<std::uint64_t>(steps)});
}

Outcome timeline_get(Client& client, Request& request) {
  return without_parameters<session::GetTimeline>(client, request);
}

Outcome timeline_resume(Client& client, Request& request) {
  Params params(request.params);
  constexpr std::int64_t most = (std::int64_t{1} << 53) - 1;  // JSON numbers are exact up to here
  const bool back = params.has("undo"), said = params.flag("undo");
  if (back && (!said || params.has("step"))) params.refuse("undo", "true, and no step beside it");
  const std::int64_t step =
      params.integer("step", 0, most, back ? std::optional<std::int64_t>(0) : std::nullopt);
  if (auto error = params.check()) return *error;
  session::ResumeAt resume;
  if (!back) resume.step = static_cast<std::uint64_t>(step);
  return ask_session(client, request, resume);
}

Outcome sim_speed(Client& client, Request& request) {
  Params params(request.params);
  const double factor = params.number("factor", session::min_speed, session::max_speed, std::nullopt);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, session::Speed{factor});
}

}  // namespace clothlab::net
