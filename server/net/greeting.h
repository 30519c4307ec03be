// What a client is told first: who it talks to, what it may do and within which limits.
#pragma once

#include <nlohmann/json.hpp>

namespace clothlab::net {

class Client;
class Hub;
class Room;

nlohmann::json hello_params(const Hub& hub, const Room& room, const Client& client);

}  // namespace clothlab::net
