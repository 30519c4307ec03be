// Plain HTTP: the page, /healthz, /metrics and the API. Each request has one object, on the service thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/net/web_files.h"
#include "server/session/exporter.h"

struct lws;

namespace clothlab::net {

class Hub;

struct HttpAnswer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
};

class HttpRequest {
 public:
  HttpRequest(Hub& hub, const WebFiles& files, lws* wsi);
  ~HttpRequest();
  HttpRequest(const HttpRequest&) = delete;
  HttpRequest& operator=(const HttpRequest&) = delete;

  /// Starts the answer to the request. Returns 0, or -1 if the request is refused and its connection must be
  /// closed.
  int begin(const std::string& path);
  /// Sends the next part of the answer. Returns 1 if the answer is complete, 0 if not yet, -1 to close the
  /// connection.
  int writeable();
  /// Answers with the picture or mesh that this request asked for, or with the error.
  void deliver(session::Exported exported);
  /// True if the client has closed the connection, so that nobody waits for the answer.
  bool hung_up() const;

 private:
  /// Answers with what is at this path, or asks a session for it.
  void find(const std::string& path);
  HttpAnswer file(const std::string& path) const;
  /// Answers the paths that need a token, if the server has one: /metrics and the API.
  void inside(const std::string& path);
  void ask_session(const std::string& session, session::Export what);
  void answer(HttpAnswer answer);
  /// Refuses a request that may have a body, and returns -1. The refusal is written at once: if it waited
  /// until the socket is writeable, libwebsockets would take the body for the next request.
  int refuse(HttpAnswer refusal);
  /// Returns -1 if the headers could not be sent, 0 if the body follows, 1 if the answer has no body.
  int send_headers();
  bool send_body();
  /// The answer that refuses a client without a valid token; empty: the client may go on.
  std::optional<HttpAnswer> refusal() const;

  Hub& hub_;
  const WebFiles& files_;
  lws* wsi_;
  std::uint64_t id_;
  bool head_ = false;
  bool last_ = false;  ///< the answer says that the connection will be closed
  bool answered_ = false, headers_sent_ = false;
  HttpAnswer answer_;
};

}  // namespace clothlab::net
