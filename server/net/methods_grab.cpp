// grab.*: a client's hands on the cloth. The session's thread carries them out in order.
#include <cmath>

#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/ranges.h"

namespace clothlab::net {

namespace {

int read_hand(Params& params) {
  return static_cast<int>(params.integer("hand", 0, max_hand, 0));
}

/// A place [m] of three coordinates.
scene::dvec3 read_target(Params& params) {
  const scene::Range& range = scene::ranges::position;
  const json& value = params.value("target");
  scene::dvec3 place(0.0);
  bool good = value.is_array() && value.size() == 3;
  for (int axis = 0; good && axis < 3; ++axis) {
    const json& coordinate = value[static_cast<std::size_t>(axis)];
    good = coordinate.is_number();
    if (good) place[axis] = coordinate.get<double>();
    good = good && place[axis] >= range.minimum && place[axis] <= range.maximum;
  }
  if (!good) params.refuse("target", "three coordinates in m, each a number in [-1e6, 1e6]");
  return place;
}

}  // namespace

Outcome grab_start(Client& client, Request& request) {
  Params params(request.params);
  session::GrabStart start;
  constexpr std::int64_t most = scene::max_vertices - 1;
  start.cloth = static_cast<std::uint32_t>(params.integer("cloth", 0, most, std::nullopt));
  start.vertex = static_cast<std::uint32_t>(params.integer("vertex", 0, most, std::nullopt));
  start.target = read_target(params);
  start.hand = read_hand(params);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, start);
}

Outcome grab_move(Client& client, Request& request) {
  Params params(request.params);
  session::GrabMove move;
  move.target = read_target(params);
  move.hand = read_hand(params);
  if (auto error = params.check()) return *error;
  return ask_session(client, request, move);
}

Outcome grab_end(Client& client, Request& request) {
  Params params(request.params);
  session::GrabEnd end{read_hand(params)};
  if (auto error = params.check()) return *error;
  return ask_session(client, request, end);
}

}  // namespace clothlab::net
