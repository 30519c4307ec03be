// The methods of the protocol (README.md here): each checks its request and carries the request out.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/net/json_rpc.h"
#include "server/session/exchange.h"

namespace clothlab::net {

class Client;

/// A request's outcome while no answer is known: the session's thread will answer.
struct AnsweredLater {};
using Outcome = std::variant<json, RpcError, AnsweredLater>;

/// Checks the method's name, the client's role and the parameters, then carries the request out.
Outcome call(Client& client, const Request& request);

/// The names of all methods that the server supports, or a relay.
std::vector<std::string> method_names(bool on_relay);
bool is_method(const std::string& name);

/// Says which client an answer goes to, and which of its requests the answer belongs to.
session::Ticket ticket(const Client& client, const Request& request);

/// Passes `what` to the client's session, which will answer. Error: too many of the client's requests wait.
Outcome ask_session(Client& client, const Request& request, decltype(session::Command::what) what);

// The groups of methods, each in its own file methods_GROUP.cpp.
Outcome grab_end(Client& client, const Request& request);
Outcome grab_move(Client& client, const Request& request);
Outcome grab_start(Client& client, const Request& request);
Outcome inspect_contacts(Client& client, const Request& request);
Outcome inspect_elements(Client& client, const Request& request);
Outcome inspect_springs(Client& client, const Request& request);
Outcome mesh_upload(Client& client, const Request& request);
Outcome record_get(Client& client, const Request& request);
Outcome record_start(Client& client, const Request& request);
Outcome record_stop(Client& client, const Request& request);
Outcome scene_get(Client& client, const Request& request);
Outcome scene_load(Client& client, const Request& request);
Outcome scene_patch(Client& client, const Request& request);
Outcome scene_presets(Client& client, const Request& request);
Outcome scene_redo(Client& client, const Request& request);
Outcome scene_undo(Client& client, const Request& request);
Outcome sim_play(Client& client, const Request& request);
Outcome sim_pause(Client& client, const Request& request);
Outcome sim_step(Client& client, const Request& request);
Outcome sim_reset(Client& client, const Request& request);
Outcome sim_speed(Client& client, const Request& request);
Outcome timeline_get(Client& client, const Request& request);
Outcome timeline_resume(Client& client, const Request& request);
Outcome stream_subscribe(Client& client, const Request& request);
Outcome stream_unsubscribe(Client& client, const Request& request);
Outcome stream_ack(Client& client, const Request& request);
Outcome lab_cancel(Client& client, const Request& request);
Outcome lab_chart(Client& client, const Request& request);
Outcome lab_choose(Client& client, const Request& request);
Outcome lab_compare(Client& client, const Request& request);
Outcome lab_export(Client& client, const Request& request);
Outcome lab_jobs(Client& client, const Request& request);
Outcome lab_moments(Client& client, const Request& request);
Outcome lab_simplify(Client& client, const Request& request);
Outcome lab_stability(Client& client, const Request& request);

}  // namespace clothlab::net
