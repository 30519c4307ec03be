// Plain HTTP: the page, /healthz, /metrics and the API. One object a request, on the service thread.
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

  /// Refuses the request, or answers it. -1: the request is refused, and its connection is to be closed.
  int begin(const std::string& path);
  /// Sends the next part; -1 closes the connection, 1: the answer is complete.
  int writeable();
  /// What it asked to be made.
  void deliver(session::Exported exported);
  /// Who asked is no longer there to be answered.
  bool hung_up() const;

 private:
  /// Answers what is at that path, or asks a session for it.
  void find(const std::string& path);
  HttpAnswer file(const std::string& path) const;
  /// What only those see who have a token: /metrics and the API.
  void inside(const std::string& path);
  void ask_session(const std::string& session, session::Export what);
  void answer(HttpAnswer answer);
  /// Refuses a request that may have a body, and returns -1. The refusal is written at once: libwebsockets
  /// would take the body for the next request while this one waits until its socket can be written.
  int refuse(HttpAnswer refusal);
  /// -1: it could not be sent, 0: the body follows, 1: that was all.
  int send_headers();
  bool send_body();
  /// Why who asks may not see that, if so.
  std::optional<HttpAnswer> refusal() const;

  Hub& hub_;
  const WebFiles& files_;
  lws* wsi_;
  std::uint64_t id_;
  bool head_ = false;
  bool last_ = false;  ///< says in its answer that the connection is closed
  bool answered_ = false, headers_sent_ = false;
  HttpAnswer answer_;
};

}  // namespace clothlab::net
