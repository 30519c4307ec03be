// stream.*: which frames this client gets. The service thread answers, without waiting for the session.
#include <limits>
#include <optional>
#include <string>

#include "server/net/client.h"
#include "server/net/methods.h"
#include "server/scene/reader.h"

namespace clothlab::net {

namespace {
/// The names of all encodings, for an error: "f32 or q16 or c16".
std::string allowed() {
  std::string list;
  for (const stream::EncodingFacts& encoding : stream::encodings)
    list += (list.empty() ? "" : " or ") + std::string(encoding.name);
  return list;
}

std::string allowed_fields(const std::string& found) {
  scene::Words names{stream::no_field};
  for (const stream::FieldFacts& field : stream::fields) names.emplace_back(field.name);
  return "one of " + scene::quoted(names) + scene::suggestion(found, names);
}
}  // namespace

Outcome stream_subscribe(Client& client, Request& request) {
  Params params(request.params);
  const std::string name = params.text("encoding", "q16");
  const std::optional<stream::Encoding> encoding = stream::encoding_of(name);
  if (!encoding) params.refuse("encoding", allowed());
  const std::string field_name = params.text("field", stream::no_field);
  const std::optional<stream::Field> field = stream::field_of(field_name);
  if (!field) params.refuse("field", allowed_fields(field_name));
  const double rate = params.number("rate", min_rate, max_rate, 60);
  const std::int64_t in_flight = params.integer("in_flight", 1, max_in_flight, 2);
  if (auto error = params.check()) return *error;
  client.subscribe({*encoding, *field}, rate, static_cast<int>(in_flight));
  json agreed{{"encoding", name}, {"rate", rate}, {"in_flight", in_flight}};
  if (*field != stream::Field::none) agreed["field"] = field_name;
  return agreed;
}

Outcome stream_unsubscribe(Client& client, Request& request) {
  Params params(request.params);
  if (auto error = params.check()) return *error;
  client.unsubscribe();
  return json::object();
}

Outcome stream_ack(Client& client, Request& request) {
  Params params(request.params);
  const std::int64_t frame =
      params.integer("frame", 0, std::numeric_limits<std::uint32_t>::max(), std::nullopt);
  if (auto error = params.check()) return *error;
  client.acknowledge(static_cast<std::uint32_t>(frame));
  return json::object();
}

}  // namespace clothlab::net
