// What sim.status says of a session's own status.
#pragma once

#include "server/net/json_rpc.h"
#include "server/session/exchange.h"

namespace clothlab::net {

json status_of_session(const session::Status& status);

}  // namespace clothlab::net
