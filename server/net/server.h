// The server: libwebsockets' context, the listening socket and the service loop. One thread, the service
// thread, runs it.
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
  /// Makes a server that listens. Error: the address is in use, a certificate cannot be read, ...
  static Result<std::unique_ptr<Server>> listen(Options options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url() const;
  /// Opens the session `main`, calls `ready` once that session has started, and serves until `stop`. Returns
  /// why the session could not start; empty if it did.
  std::optional<session::Failed> run(const std::function<void()>& ready);
  /// Ends `run`. Any thread, and signal handlers, may call it.
  void stop();

  // For the callbacks of libwebsockets.
  Hub& hub() { return hub_; }
  const WebFiles& files() const { return files_; }
  /// The HTTP status to refuse a handshake with, and the reason in `why`; 0: the handshake may go on.
  unsigned refusal(lws* wsi, std::string& why);

 private:
  explicit Server(Options options);
  void say_goodbye();
  void look_each_second();

  lws_retry_bo_t keep_alive_;
  WebFiles files_ = WebFiles::load();
  std::atomic<bool> stopping_{false};
  std::atomic<lws_context*> context_{nullptr};
  lws_vhost* vhost_ = nullptr;
  struct Look {
    lws_sorted_usec_list_t timer{};
    Server* server = nullptr;
  } look_;
  Hub hub_;
};

}  // namespace clothlab::net
