#include "server/relay/wire.h"

#include <algorithm>
#include <utility>

#include "server/scene/document.h"

namespace clothlab::relay {

namespace {

constexpr std::string_view prefix = "clothlab.";

/// As `want` and the subject spell it: "q16", or "q16.strain".
std::string name_of(stream::Form form) {
  std::string name = stream::facts(form.encoding).name;
  if (form.field != stream::Field::none)
    name += std::string(".") + stream::fields[stream::index_of(form.field)].name;
  return name;
}

template <class T>
void read(const json& from, const char* key, T& value) {
  if (const auto found = from.find(key); found != from.end()) value = found->get<T>();
}

}  // namespace

std::string subject(const std::string& session, std::string_view what) {
  return std::string(prefix) + session + "." + std::string(what);
}

std::string frame_subject(const std::string& session, stream::Form form) {
  return subject(session, name_of(form));
}

std::string answer_subject(const std::string& session, const std::string& relay) {
  return subject(session, "for." + relay);
}

std::string session_of(std::string_view subject) {
  if (!subject.starts_with(prefix)) return {};
  subject.remove_prefix(prefix.size());
  return std::string(subject.substr(0, subject.find('.')));
}

std::string text_of(const Want& want) {
  json forms = json::object();
  for (std::size_t i = 0; i < form_count; ++i)
    if (want.rates[i] > 0) forms[name_of(stream::Form::at(i))] = want.rates[i];
  return text_of(json{{"relay", want.relay},
                      {"viewers", want.viewers},
                      {"forms", std::move(forms)},
                      {"known",
                       {{"origin", want.known.origin},
                        {"revision", want.known.revision},
                        {"topology", want.known.topology}}}});
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

json value_of(std::string_view text) {
  // A notification has the document within its parameters, with a little beside it.
  constexpr scene::TextLimits limits{scene::max_document_bytes + 64 * 1024, scene::max_json_depth + 4};
  Result<json> value = scene::parse_json(std::string(text), "the bus", false, limits);
  return value ? std::move(*value) : json();
}

std::optional<Want> read_want(std::string_view text) {
  constexpr std::size_t longest = 16 * 1024;
  if (text.size() > longest) return std::nullopt;
  try {
    const json from = value_of(text);
    if (!from.is_object()) return std::nullopt;
    Want want;
    read(from, "relay", want.relay);
    read(from, "viewers", want.viewers);
    json forms = json::object(), known = json::object();
    read(from, "forms", forms);
    read(from, "known", known);
    if (!forms.is_object() || !known.is_object()) return std::nullopt;
    for (std::size_t i = 0; i < form_count; ++i)
      read(forms, name_of(stream::Form::at(i)).c_str(), want.rates[i]);
    read(known, "origin", want.known.origin);
    read(known, "revision", want.known.revision);
    read(known, "topology", want.known.topology);
    want.viewers = std::clamp(want.viewers, 0, most_viewers);
    for (double& rate : want.rates) {
      if (!(rate >= 0)) return std::nullopt;
      rate = std::min(rate, most_rate);
    }
    return want;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace clothlab::relay
