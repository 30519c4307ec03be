#include "server/net/methods.h"

#include <algorithm>
#include <array>

#include "server/net/client.h"

namespace clothlab::net {

namespace {

Outcome ping(Client&, const Request& request) {
  Params params(request.params);
  const json& t = params.value("t");
  if (auto error = params.check()) return *error;
  return json{{"t", t}};
}

Outcome auth(Client& client, const Request& request) {
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
  bool operators_only;  ///< true: only operators may call the method
  Outcome (*run)(Client&, const Request&);
};

constexpr std::array methods{
    Method{"auth", false, auth},
    Method{"grab.end", true, grab_end},
    Method{"grab.move", true, grab_move},
    Method{"grab.start", true, grab_start},
    Method{"inspect.contacts", false, inspect_contacts},
    Method{"inspect.elements", false, inspect_elements},
    Method{"inspect.springs", false, inspect_springs},
    Method{"lab.cancel", true, lab_cancel},
    Method{"lab.chart", true, lab_chart},
    Method{"lab.choose", true, lab_choose},
    Method{"lab.compare", true, lab_compare},
    Method{"lab.export", true, lab_export},
    Method{"lab.jobs", true, lab_jobs},
    Method{"lab.moments", true, lab_moments},
    Method{"lab.simplify", true, lab_simplify},
    Method{"lab.stability", true, lab_stability},
    Method{"mesh.upload", true, mesh_upload},
    Method{"ping", false, ping},
    Method{"record.get", false, record_get},
    Method{"record.start", true, record_start},
    Method{"record.stop", true, record_stop},
    Method{"scene.get", false, scene_get},
    Method{"scene.load", true, scene_load},
    Method{"scene.patch", true, scene_patch},
    Method{"scene.presets", false, scene_presets},
    Method{"scene.redo", true, scene_redo},
    Method{"scene.undo", true, scene_undo},
    Method{"sim.pause", true, sim_pause},
    Method{"sim.play", true, sim_play},
    Method{"sim.reset", true, sim_reset},
    Method{"sim.speed", true, sim_speed},
    Method{"sim.step", true, sim_step},
    Method{"stream.ack", false, stream_ack},
    Method{"stream.subscribe", false, stream_subscribe},
    Method{"stream.unsubscribe", false, stream_unsubscribe},
    Method{"timeline.get", false, timeline_get},
    Method{"timeline.resume", true, timeline_resume},
};

RpcError unknown(const std::string& method) {
  return {error_unknown_method, method + ": there is no such method", {{"allowed", method_names()}}};
}

}  // namespace

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method& method : methods) names.emplace_back(method.name);
  return names;
}

bool is_method(const std::string& name) {
  return std::any_of(methods.begin(), methods.end(),
                     [&](const Method& method) { return name == method.name; });
}

session::Ticket ticket(const Client& client, const Request& request) {
  return {client.id(), request.id, request.method, request.received_us};
}

Outcome ask_session(Client& client, const Request& request, decltype(session::Command::what) what) {
  if (client.room()->offer({ticket(client, request), std::move(what)})) return AnsweredLater{};
  return RpcError{error_over_limit,
                  std::to_string(session::max_waiting_commands) +
                      " of your requests wait already; wait for their answers",
                  nullptr};
}

Outcome call(Client& client, const Request& request) {
  if (client.role() == Role::none && request.method != "auth")
    return RpcError{error_not_allowed, "this server requires a token: call auth {token} first", nullptr};
  const auto method = std::find_if(methods.begin(), methods.end(),
                                   [&](const Method& candidate) { return request.method == candidate.name; });
  if (method == methods.end()) return unknown(request.method);
  if (method->operators_only && client.role() != Role::operator_)
    return RpcError{error_not_allowed, request.method + " changes something; a viewer may only look",
                    nullptr};
  if (!client.room() && request.method != "auth")
    return RpcError{error_over_limit, "no session is open for this connection; connect again", nullptr};
  return method->run(client, request);
}

}  // namespace clothlab::net
