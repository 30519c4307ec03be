#include "server/net/methods.h"

#include <algorithm>
#include <array>

#include "server/net/client.h"

namespace clothlab::net {

namespace {

Outcome ping(Client&, Request& request) {
  Params params(request.params);
  const json& t = params.value("t");
  if (auto error = params.check()) return *error;
  return json{{"t", t}};
}

Outcome auth(Client& client, Request& request) {
  Params params(request.params);
  const std::string token = params.text("token", std::nullopt);
  if (auto error = params.check()) return *error;
  const auto [role, wait] =
      client.hub().check_token(token, client.address(), {{"client", std::to_string(client.id())}});
  if (wait > 0) return RpcError{error_over_limit, token_wait_message(wait), nullptr};
  if (role == Role::none)
    return RpcError{error_not_allowed, "this token is not valid on this server; see --token and --view-token",
                    nullptr};
  if (role == Role::viewer && !client.hub().knows_session(client.session()))
    return RpcError{error_not_allowed,
                    "no session " + client.session() + " is open; an operator opens it by connecting to it",
                    nullptr};
  if (!client.admit(role))
    return RpcError{error_over_limit,
                    client.hub().elsewhere(client.session())
                        ? "another server has this session open; connect again"
                        : "too many sessions; see --max-sessions",
                    nullptr};
  return json{{"role", name(role)}};
}

struct Method {
  const char* name;
  enum class For {
    everybody,
    direct,    ///< everybody but viewers of a relay, which has no session to ask
    operators  ///< it changes something
  } who;
  Outcome (*run)(Client&, Request&);
};

using For = Method::For;

constexpr std::array methods{
    Method{"auth", For::everybody, auth},
    Method{"grab.end", For::operators, grab_end},
    Method{"grab.move", For::operators, grab_move},
    Method{"grab.start", For::operators, grab_start},
    Method{"inspect.contacts", For::direct, inspect_contacts},
    Method{"inspect.elements", For::direct, inspect_elements},
    Method{"inspect.springs", For::direct, inspect_springs},
    Method{"inspect.vertices", For::direct, inspect_vertices},
    Method{"lab.cancel", For::operators, lab_cancel},
    Method{"lab.chart", For::operators, lab_chart},
    Method{"lab.choose", For::operators, lab_choose},
    Method{"lab.compare", For::operators, lab_compare},
    Method{"lab.export", For::operators, lab_export},
    Method{"lab.jobs", For::operators, lab_jobs},
    Method{"lab.moments", For::operators, lab_moments},
    Method{"lab.simplify", For::operators, lab_simplify},
    Method{"lab.stability", For::operators, lab_stability},
    Method{"mesh.upload", For::operators, mesh_upload},
    Method{"ping", For::everybody, ping},
    Method{"record.get", For::direct, record_get},
    Method{"record.start", For::operators, record_start},
    Method{"record.stop", For::operators, record_stop},
    Method{"scene.get", For::everybody, scene_get},
    Method{"scene.load", For::operators, scene_load},
    Method{"scene.patch", For::operators, scene_patch},
    Method{"scene.presets", For::everybody, scene_presets},
    Method{"scene.redo", For::operators, scene_redo},
    Method{"scene.undo", For::operators, scene_undo},
    Method{"sim.pause", For::operators, sim_pause},
    Method{"sim.play", For::operators, sim_play},
    Method{"sim.reset", For::operators, sim_reset},
    Method{"sim.speed", For::operators, sim_speed},
    Method{"sim.step", For::operators, sim_step},
    Method{"stream.ack", For::everybody, stream_ack},
    Method{"stream.subscribe", For::everybody, stream_subscribe},
    Method{"stream.unsubscribe", For::everybody, stream_unsubscribe},
    Method{"timeline.get", For::direct, timeline_get},
    Method{"timeline.resume", For::operators, timeline_resume},
};

RpcError unknown(const std::string& method, bool on_relay) {
  return {error_unknown_method, method + ": there is no such method", {{"allowed", method_names(on_relay)}}};
}

}  // namespace

std::vector<std::string> method_names(bool on_relay) {
  std::vector<std::string> names;
  for (const Method& method : methods)
    if (!on_relay || method.who == For::everybody) names.emplace_back(method.name);
  return names;
}

bool is_method(const std::string& name) {
  return std::any_of(methods.begin(), methods.end(),
                     [&](const Method& method) { return name == method.name; });
}

session::Ticket ticket(const Client& client, const Request& request) {
  return {client.id(), request.id, request.method, request.received_us};
}

RpcError too_many_waiting() {
  return {error_over_limit,
          std::to_string(session::max_waiting_commands) +
              " of your requests wait already; wait for their answers",
          nullptr};
}

Outcome ask_session(Client& client, const Request& request, decltype(session::Command::what) what) {
  if (client.room()->offer({ticket(client, request), std::move(what)})) return AnsweredLater{};
  return too_many_waiting();
}

Outcome ask_at_length(Client& client, const Request& request, decltype(session::Command::what) what) {
  if (!request.id) return ask_session(client, request, std::move(what));  // gets no answer
  if (client.ask_at_length({ticket(client, request), std::move(what)})) return AnsweredLater{};
  return too_many_waiting();
}

Outcome call(Client& client, Request& request) {
  if (client.role() == Role::none && request.method != "auth")
    return RpcError{error_not_allowed, "this server requires a token: call auth {token} first", nullptr};
  const auto method = std::find_if(methods.begin(), methods.end(),
                                   [&](const Method& candidate) { return request.method == candidate.name; });
  if (method == methods.end()) return unknown(request.method, client.hub().relays());
  if (method->who == For::operators && client.role() != Role::operator_)
    return RpcError{error_not_allowed, request.method + " changes something; a viewer may only look",
                    nullptr};
  if (method->who == For::direct && client.hub().relays())
    return RpcError{
        error_not_allowed,
        request.method + " is answered by the server that runs the session; a relay only passes frames on",
        nullptr};
  if (!client.room() && request.method != "auth")
    return RpcError{error_over_limit, "no session is open for this connection; connect again", nullptr};
  return method->run(client, request);
}

}  // namespace clothlab::net
