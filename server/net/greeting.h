// The parameters of `hello`, the first message to a client: the server, the client's role and its limits.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace clothlab::net {

class Client;
class Hub;
class Room;

nlohmann::json hello_params(const Hub& hub, const Room& room, const Client& client);

}  // namespace clothlab::net
