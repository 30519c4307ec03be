// The methods of the protocol: what each needs and what it does. See README.md here.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/net/json_rpc.h"
#include "server/session/exchange.h"

namespace clothlab::net {

class Client;

/// The session's thread will answer.
struct Later {};
using Outcome = std::variant<json, RpcError, Later>;

/// Checks the method's name, the client's role and the parameters, and carries the request out.
Outcome call(Client& client, const Request& request);

/// What a client may call.
std::vector<std::string> method_names();
bool is_method(const std::string& name);

session::Ticket ticket(const Client& client, const Request& request);

/// Leaves it to the client's session, or says that it is too busy.
Outcome ask_session(Client& client, const Request& request, decltype(session::Command::what) what);

// The groups of methods, one file each.
Outcome scene_get(Client& client, const Request& request);
Outcome scene_load(Client& client, const Request& request);
Outcome scene_patch(Client& client, const Request& request);
Outcome scene_presets(Client& client, const Request& request);
Outcome sim_play(Client& client, const Request& request);
Outcome sim_pause(Client& client, const Request& request);
Outcome sim_step(Client& client, const Request& request);
Outcome sim_reset(Client& client, const Request& request);
Outcome sim_speed(Client& client, const Request& request);
Outcome stream_subscribe(Client& client, const Request& request);
Outcome stream_unsubscribe(Client& client, const Request& request);
Outcome stream_ack(Client& client, const Request& request);
Outcome lab_cancel(Client& client, const Request& request);
Outcome lab_chart(Client& client, const Request& request);
Outcome lab_choose(Client& client, const Request& request);
Outcome lab_export(Client& client, const Request& request);
Outcome lab_jobs(Client& client, const Request& request);
Outcome lab_simplify(Client& client, const Request& request);
Outcome lab_stability(Client& client, const Request& request);

}  // namespace clothlab::net
