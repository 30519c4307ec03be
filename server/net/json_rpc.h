// A subset of JSON-RPC 2.0 (README.md here): named parameters only, no batches; errors say what would be
// allowed.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/base/result.h"
#include "server/scene/document.h"
#include "server/session/exchange.h"

namespace clothlab::net {

using nlohmann::json;

enum ErrorCode : int {
  error_parse = -32700,
  error_invalid_request = -32600,
  error_unknown_method = -32601,
  error_invalid_params = -32602,
  error_internal = -32603,
  error_not_allowed = -32001,
  error_over_limit = -32002,
  error_revision_conflict = -32003,
  error_diverged = -32004,
  error_nothing_there = -32005,  ///< nothing to undo or redo
  error_given_up = -32006,       ///< a change was given up while it was built
};

struct RpcError {
  int code = error_internal;
  std::string message;
  json data = nullptr;  ///< left out of the message when null
};

/// Error -32602 with data {path, found, allowed}.
RpcError invalid_params(const std::string& path, const std::string& found, const std::string& allowed);
/// Error -32602 from a scene error, whose `where` is a JSON Pointer and becomes `path`; its facts join the
/// data.
RpcError invalid_params(const Error& error);
/// The error for a session's refusal, with the code for the refusal's reason.
RpcError rpc_error(const session::Refusal& refusal);

/// A call from a client; without an id it is a notification and is never answered.
struct Request {
  std::string method;
  json params = json::object();
  std::optional<json> id;
  std::int64_t received_us = 0;  ///< when the request came, by the steady clock [us]
};

/// A message that is no valid request: the error, and the id to answer to (null if it is unknown).
struct BadRequest {
  RpcError error;
  json id = nullptr;
  bool notification = false;  ///< valid but for its params, and without an id: not answered
};

/// Reads one text message. Errors: -32700 if the text is not JSON or is beyond `limits`, -32600 if it is a
/// batch or no request, -32602 if its parameters are positional.
std::variant<Request, BadRequest> parse_request(const std::string& text, scene::TextLimits limits = {});

// Messages to the client, as text.
std::string result_text(const json& id, const json& result);
std::string result_text(const json& id, const session::JsonText& result);
std::string error_text(const json& id, const RpcError& error);
std::string notification_text(const char* method, const json& params);
std::string notification_text(const char* method, const session::JsonText& params);

/// Reads named parameters one by one and keeps the first fault. `check` also refuses parameters of names that
/// were never read.
class Params {
 public:
  explicit Params(const json& params) : params_(params) {}

  /// A finite number in [least, most]; `fallback` if the parameter is left out.
  double number(const char* name, double least, double most, std::optional<double> fallback);
  std::int64_t integer(const char* name, std::int64_t least, std::int64_t most,
                       std::optional<std::int64_t> fallback);
  std::string text(const char* name, std::optional<std::string> fallback);
  /// A text of 1 to `most` bytes without control characters.
  std::string label(const char* name, std::size_t most, std::optional<std::string> fallback);
  /// True or false; false if the parameter is left out.
  bool flag(const char* name);
  /// The parameter's value of any type; null if it is left out.
  const json& value(const char* name);
  bool has(const char* name) const { return params_.contains(name); }

  void refuse(const char* name, const std::string& allowed);
  /// The first fault, an unknown name included; empty: none.
  std::optional<RpcError> check();

 private:
  const json* find(const char* name);

  const json& params_;
  std::vector<std::string> known_;
  std::optional<RpcError> error_;
};

}  // namespace clothlab::net
