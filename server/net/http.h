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

  /// Works out the answer, or asks a session for it.
  void begin(const std::string& path);
  /// Sends the next part; -1 closes the connection, 1: the answer is complete.
  int writeable();
  /// What it asked to be made.
  void deliver(session::Exported exported);
  /// Who asked is no longer there to be answered.
  bool hung_up() const;

 private:
  HttpAnswer file(const std::string& path) const;
  /// What only those see who have a token: /metrics and the API.
  void inside(const std::string& path);
  void ask_session(const std::string& session, session::Export what);
  void answer(HttpAnswer answer);
  int send_headers();
  /// Why who asks may not see that, if so.
  std::optional<HttpAnswer> refusal() const;

  Hub& hub_;
  const WebFiles& files_;
  lws* wsi_;
  std::uint64_t id_;
  bool head_ = false;
  bool last_ = false;  ///< the connection is closed once this is answered
  bool answered_ = false, headers_sent_ = false;
  HttpAnswer answer_;
};

}  // namespace clothlab::net
