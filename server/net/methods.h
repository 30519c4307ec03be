// The methods of the protocol (README.md here): each checks its request and carries the request out.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/net/json_rpc.h"
#include "server/session/exchange.h"

namespace clothlab::net {

class Client;

/// A request's outcome while no answer is known: the session's thread, or the workbench, will answer.
struct AnsweredLater {};
using Outcome = std::variant<json, RpcError, AnsweredLater>;

/// Checks the method's name, the client's role and the parameters, then carries the request out. Large
/// parameters are taken out of the request.
Outcome call(Client& client, Request& request);

/// The names of all methods that the server supports, or a relay.
std::vector<std::string> method_names(bool on_relay);
bool is_method(const std::string& name);

/// Says which client an answer goes to, and which of its requests the answer belongs to.
session::Ticket ticket(const Client& client, const Request& request);

/// Passes `what` to the client's session, which will answer. Error: too many of the client's requests wait.
Outcome ask_session(Client& client, const Request& request, decltype(session::Command::what) what);
/// The same for what may be answered at length (Client::ask_at_length).
Outcome ask_at_length(Client& client, const Request& request, decltype(session::Command::what) what);
RpcError too_many_waiting();

// The groups of methods, each in its own file methods_GROUP.cpp.
Outcome grab_end(Client& client, Request& request);
Outcome grab_move(Client& client, Request& request);
Outcome grab_start(Client& client, Request& request);
Outcome inspect_contacts(Client& client, Request& request);
Outcome inspect_elements(Client& client, Request& request);
Outcome inspect_springs(Client& client, Request& request);
Outcome inspect_vertices(Client& client, Request& request);
Outcome mesh_upload(Client& client, Request& request);
Outcome record_get(Client& client, Request& request);
Outcome record_start(Client& client, Request& request);
Outcome record_stop(Client& client, Request& request);
Outcome scene_get(Client& client, Request& request);
Outcome scene_load(Client& client, Request& request);
Outcome scene_patch(Client& client, Request& request);
Outcome scene_presets(Client& client, Request& request);
Outcome scene_redo(Client& client, Request& request);
Outcome scene_undo(Client& client, Request& request);
Outcome sim_play(Client& client, Request& request);
Outcome sim_pause(Client& client, Request& request);
Outcome sim_step(Client& client, Request& request);
Outcome sim_reset(Client& client, Request& request);
Outcome sim_speed(Client& client, Request& request);
Outcome timeline_get(Client& client, Request& request);
Outcome timeline_resume(Client& client, Request& request);
Outcome stream_subscribe(Client& client, Request& request);
Outcome stream_unsubscribe(Client& client, Request& request);
Outcome stream_ack(Client& client, Request& request);
Outcome lab_cancel(Client& client, Request& request);
Outcome lab_chart(Client& client, Request& request);
Outcome lab_choose(Client& client, Request& request);
Outcome lab_compare(Client& client, Request& request);
Outcome lab_export(Client& client, Request& request);
Outcome lab_jobs(Client& client, Request& request);
Outcome lab_moments(Client& client, Request& request);
Outcome lab_simplify(Client& client, Request& request);
Outcome lab_stability(Client& client, Request& request);

}  // namespace clothlab::net
