// The server: libwebsockets' context and callbacks, the listening socket, the service loop. One thread runs
// it.
#pragma once

#include <libwebsockets.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "server/net/hub.h"
#include "server/net/web_files.h"

namespace clothlab::net {

class Server {
 public:
  /// Listens. Error: the address is in use, a certificate cannot be read, ...
  static Result<std::unique_ptr<Server>> listen(Options options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url() const;
  /// Opens the session `main`, calls `ready` when it runs, and serves until `stop`. Why it could not start,
  /// if so.
  std::optional<session::Failed> run(const std::function<void()>& ready);
  /// Ends `run`. Any thread, and signal handlers, may call it.
  void stop();

  // For the callbacks of libwebsockets.
  Hub& hub() { return hub_; }
  const WebFiles& files() const { return files_; }
  /// 0: this handshake may go on; else the HTTP status to refuse it with.
  unsigned refusal(lws* wsi, std::string& why);

 private:
  explicit Server(Options options);
  void say_goodbye();

  lws_retry_bo_t keep_alive_;
  WebFiles files_ = WebFiles::load();
  std::atomic<bool> stopping_{false};
  std::atomic<lws_context*> context_{nullptr};
  lws_vhost* vhost_ = nullptr;
  Hub hub_;
};

}  // namespace clothlab::net
