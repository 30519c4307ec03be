#include "server/net/json_rpc.h"

#include <algorithm>
#include <cmath>

#include "server/scene/document.h"

namespace clothlab::net {

namespace {

std::string compact(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  constexpr std::size_t longest = 200;
  if (text.size() <= longest) return text;
  // Cut where a character begins, not before a continuation byte, so that the text stays UTF-8.
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

std::string number_text(double value) {
  return json(value).dump();
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "no parameters" : text;
}

RpcError invalid_request(const std::string& message) {
  return {error_invalid_request, message, nullptr};
}

std::string dump(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

RpcError invalid_params(const std::string& path, const std::string& found, const std::string& allowed) {
  return {error_invalid_params,
          "invalid value at " + (path.empty() ? std::string("the document") : path) + ": " + found + "; " +
              allowed,
          {{"path", path}, {"found", found}, {"allowed", allowed}}};
}

RpcError invalid_params(const Error& error) {
  RpcError refused = invalid_params(error.where, error.what, error.remedy);
  if (!error.facts.empty()) refused.data.update(json::parse(error.facts));
  return refused;
}

RpcError rpc_error(const session::Refusal& refusal) {
  using Reason = session::Refusal::Reason;
  switch (refusal.reason) {
    case Reason::invalid_value:
      return invalid_params(refusal.error);
    case Reason::other_revision:
      return {error_revision_conflict, refusal.error.text(), {{"revision", refusal.revision}}};
    case Reason::diverged:
      return {error_diverged, refusal.error.text(), nullptr};
    case Reason::nothing_there:
      return {error_nothing_there, refusal.error.text(), nullptr};
    case Reason::given_up:
      return {error_given_up, refusal.error.text(), nullptr};
    case Reason::over_limit:
      return {error_over_limit, refusal.error.text(), nullptr};
    case Reason::failed:
      break;
  }
  return {error_internal, refusal.error.text(), nullptr};
}

std::variant<Request, BadRequest> parse_request(const std::string& text, scene::TextLimits limits) {
  Result<json> parsed = scene::parse_json(text, "message", false, limits);
  if (!parsed) return BadRequest{{error_parse, parsed.error().text(), nullptr}};
  json& message = *parsed;
  if (message.is_array())
    return BadRequest{invalid_request("batches are not supported; send one request a message")};
  if (!message.is_object())
    return BadRequest{invalid_request("a request is an object, not " + compact(message))};
  Request request;
  json id = nullptr;
  if (const auto found = message.find("id"); found != message.end()) {
    if (!found->is_string() && !found->is_number() && !found->is_null())
      return BadRequest{invalid_request("id must be a string, a number or null, not " + compact(*found))};
    id = *found;
    request.id = id;
  }
  if (const auto version = message.find("jsonrpc"); version == message.end() || *version != "2.0")
    return BadRequest{invalid_request("\"jsonrpc\": \"2.0\" is missing"), id};
  const auto method = message.find("method");
  if (method == message.end() || !method->is_string())
    return BadRequest{invalid_request("\"method\" must be a string"), id};
  request.method = method->get<std::string>();
  if (const auto params = message.find("params"); params != message.end() && !params->is_null()) {
    if (!params->is_object())
      return BadRequest{
          {error_invalid_params,
           "invalid params: " + compact(*params) + "; an object of named parameters",
           {{"path", ""}, {"found", compact(*params)}, {"allowed", "an object of named parameters"}}},
          id,
          !request.id};
    request.params = std::move(*params);
  }
  return request;
}

std::string result_text(const json& id, const json& result) {
  return dump({{"jsonrpc", "2.0"}, {"id", id}, {"result", result}});
}

std::string result_text(const json& id, const session::JsonText& result) {
  return "{\"id\":" + dump(id) + ",\"jsonrpc\":\"2.0\",\"result\":" + *result + "}";
}

std::string error_text(const json& id, const RpcError& error) {
  json body = {{"code", error.code}, {"message", error.message}};
  if (!error.data.is_null()) body["data"] = error.data;
  return dump({{"jsonrpc", "2.0"}, {"id", id}, {"error", std::move(body)}});
}

std::string notification_text(const char* method, const json& params) {
  return dump({{"jsonrpc", "2.0"}, {"method", method}, {"params", params}});
}

std::string notification_text(const char* method, const session::JsonText& params) {
  return std::string("{\"jsonrpc\":\"2.0\",\"method\":\"") + method + "\",\"params\":" + *params + "}";
}

const json* Params::find(const char* name) {
  known_.emplace_back(name);
  const auto found = params_.find(name);
  return found == params_.end() ? nullptr : &*found;
}

void Params::refuse(const char* name, const std::string& allowed) {
  if (error_) return;
  const auto found = params_.find(name);
  error_ =
      invalid_params(std::string("/") + name, found == params_.end() ? "nothing" : compact(*found), allowed);
}

double Params::number(const char* name, double least, double most, std::optional<double> fallback) {
  const json* value = find(name);
  if (!value && fallback) return *fallback;
  const double number = value && value->is_number() ? value->get<double>() : std::nan("");
  if (number >= least && number <= most) return number;
  refuse(name, "a number in [" + number_text(least) + ", " + number_text(most) + "]");
  return least;
}

std::int64_t Params::integer(const char* name, std::int64_t least, std::int64_t most,
                             std::optional<std::int64_t> fallback) {
  const json* value = find(name);
  if (!value && fallback) return *fallback;
  if (value && value->is_number_integer()) {
    // An unsigned value beyond int64 would wrap to a negative number.
    const bool huge =
        value->is_number_unsigned() && value->get<std::uint64_t>() > static_cast<std::uint64_t>(most);
    const std::int64_t number = huge ? 0 : value->get<std::int64_t>();
    if (!huge && number >= least && number <= most) return number;
  }
  refuse(name, "a whole number in [" + std::to_string(least) + ", " + std::to_string(most) + "]");
  return least;
}

bool Params::flag(const char* name) {
  const json& found = value(name);
  if (!found.is_null() && !found.is_boolean()) refuse(name, "true or false");
  return found.is_boolean() && found.get<bool>();
}

std::string Params::text(const char* name, std::optional<std::string> fallback) {
  const json* value = find(name);
  if (!value && fallback) return *fallback;
  if (value && value->is_string()) return value->get<std::string>();
  refuse(name, "a string");
  return {};
}

std::string Params::label(const char* name, std::size_t most, std::optional<std::string> fallback) {
  const bool given = has(name);
  std::string label = text(name, std::move(fallback));
  const bool control =
      std::any_of(label.begin(), label.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; });
  if (given && (label.empty() || label.size() > most || control))
    refuse(name, "a text of 1 to " + std::to_string(most) + " bytes, without control characters");
  return label;
}

const json& Params::value(const char* name) {
  static const json nothing = nullptr;
  const json* value = find(name);
  return value ? *value : nothing;
}

std::optional<RpcError> Params::check() {
  for (const auto& [name, value] : params_.items()) {
    if (error_ || std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    error_ = invalid_params("/" + name, compact(value), list(known_));
  }
  return error_;
}

}  // namespace clothlab::net
