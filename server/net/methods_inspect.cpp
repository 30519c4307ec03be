// inspect.*: what the simulation is made of and what touches what, for who looks. They change nothing.
#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/ranges.h"
#include "server/session/limits.h"

namespace clothlab::net {

namespace {

std::size_t read_first(Params& params) {
  return static_cast<std::size_t>(params.integer("first", 0, 64 * scene::max_vertices, 0));
}

template <class What>
Outcome from_first(Client& client, Request& request) {
  Params params(request.params);
  const What what{read_first(params)};
  if (auto error = params.check()) return *error;
  return ask_at_length(client, request, what);
}

}  // namespace

Outcome inspect_springs(Client& client, Request& request) {
  return from_first<session::InspectSprings>(client, request);
}

Outcome inspect_elements(Client& client, Request& request) {
  return from_first<session::InspectElements>(client, request);
}

Outcome inspect_vertices(Client& client, Request& request) {
  Params params(request.params);
  const auto cloth = static_cast<std::uint32_t>(params.integer("cloth", 0, scene::max_vertices - 1, 0));
  const session::InspectVertices what{cloth, read_first(params)};
  if (auto error = params.check()) return *error;
  return ask_at_length(client, request, what);
}

Outcome inspect_contacts(Client& client, Request& request) {
  Params params(request.params);
  const std::int64_t most = params.integer("most", 0, session::max_inspected_contacts, 1000);
  if (auto error = params.check()) return *error;
  return ask_at_length(client, request, session::InspectContacts{static_cast<std::size_t>(most)});
}

}  // namespace clothlab::net
