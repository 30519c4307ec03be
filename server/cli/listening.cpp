#include "server/cli/listening.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <thread>
#include <utility>

#include "server/base/log.h"
#include "server/base/memory.h"
#include "server/base/memory_limit.h"
#include "server/cli/descriptors.h"
#include "server/net/request_headers.h"
#include "server/net/server.h"

namespace clothlab::cli {

namespace {

/// Stops the server on SIGINT or SIGTERM. Both must be blocked in all threads: the thread made here waits for
/// them. The process exits by force if the server has not ended within 3 s (a driver may hang), and on a
/// second signal. Sessions are saved about twice a second (with --state-dir), so at most the last second is
/// lost.
class StopOnSignal {
 public:
  explicit StopOnSignal(net::Server& server)
      : server_(&server), thread_([this] {
          const sigset_t signals = stop_signals();
          int received = 0;
          sigwait(&signals, &received);
          if (ended_) return;
          stop_server();
          constexpr timespec patience{3, 0};
          sigtimedwait(&signals, nullptr, &patience);
          if (ended_) return;
          log(LogLevel::warning, "cut_short",
              {{"why",
                "the server did not stop within 3 s, or before a second signal; with --state-dir, sessions "
                "were last saved up to about 1 s ago"}});
          std::_Exit(exit_done);
        }) {}
  /// To be called before the server is destroyed: from then on no signal calls the server.
  void forget_server() {
    const std::lock_guard lock(mutex_);
    server_ = nullptr;
  }
  /// Runs after the server is destroyed: a server that hangs meanwhile is still ended by force. The SIGTERM
  /// wakes the waiting thread.
  ~StopOnSignal() {
    ended_ = true;
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Blocks both signals and ignores SIGPIPE. To be called before any thread starts: threads inherit this.
  static void block() {
    const sigset_t signals = stop_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }

 private:
  void stop_server() {
    const std::lock_guard lock(mutex_);
    if (server_) server_->stop();
  }
  static sigset_t stop_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    return signals;
  }
  std::mutex mutex_;
  net::Server* server_;
  std::atomic<bool> ended_{false};
  std::thread thread_;  ///< last, because the thread uses the members above
};

}  // namespace

void add_listening(CLI::App& command, Listening& listening, const std::string& beyond_loopback) {
  net::Options& options = listening.options;
  command.add_option("--bind", options.bind, "the address to listen on" + beyond_loopback)
      ->type_name("ADDRESS")
      ->capture_default_str();
  command.add_option("--port", options.port, "the port to listen on; 0 picks a free one")
      ->type_name("PORT")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  command
      .add_option(
          "--allow-origin", options.allow_origin,
          "an origin whose pages may connect, and show the page in a frame, besides this server's own; "
          "its host is one that this server answers as")
      ->type_name("ORIGIN")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--trusted-proxy", options.trusted_proxies,
                  "the address of a proxy whose X-Forwarded-For says where a connection comes from")
      ->type_name("ADDRESS")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--tls-cert", options.tls_certificate, "PEM file; with --tls-key: HTTPS and WSS")
      ->type_name("FILE");
  command.add_option("--tls-key", options.tls_key, "PEM file")->type_name("FILE");
  command.add_option("--log-level", listening.log_level, "the least urgent events that are logged")
      ->type_name("error|warning|info|debug")
      ->check(CLI::IsMember({"error", "warning", "info", "debug"}))
      ->capture_default_str();
}

void add_limit(CLI::App& command, const char* flag, int& value, int least, int most, const char* help) {
  command.add_option(flag, value, help)
      ->type_name("N")
      ->check(whole_number(least, most))
      ->capture_default_str()
      ->group("Limits");
}

void add_connection_limits(CLI::App& command, net::Limits& limits) {
  const auto add = [&](const char* flag, int& value, int least, int most, const char* help) {
    add_limit(command, flag, value, least, most, help);
  };
  add("--max-clients", limits.clients, 1, 100000, "WebSocket connections, over all sessions");
  add("--max-clients-per-address", limits.clients_per_address, 1, 100000,
      "WebSocket connections from one address; behind a proxy everybody has the proxy's");
  add("--max-message-bytes", limits.message_bytes, 1024, 8 << 20, "bytes in one message to the server");
  add("--max-message-rate", limits.message_rate, 10, 1000000,
      "messages a second from one client, twice that in a burst");
  add("--max-json-depth", limits.json_depth, 8, net::Limits{}.json_depth, "levels of nesting in a message");
  add("--header-timeout", limits.header_seconds, 1, 3600,
      "seconds from connecting to the last of a request's headers, TLS included");
  add("--auth-timeout", limits.auth_seconds, 1, 3600, "seconds until a client's token must have come");
  add("--max-wrong-tokens", limits.wrong_tokens, 1, 1000000,
      "wrong tokens a minute from one address; after that its tokens are refused for a while");
  add("--idle-timeout", limits.idle_seconds, 2, 3600,
      "seconds after which a connection that says nothing, not even pong, is closed");
}

void add_memory_limit(CLI::App& command, Listening& listening, const std::string& uses) {
  const auto is_size = [](std::string& text) -> std::string {
    const std::optional<std::uint64_t> bytes = memory_size(text);
    if (bytes && *bytes >= MemoryBudget::least_bytes) return {};
    return text + " is no size of at least 256M: a number of bytes, or as 512M or 2G";
  };
  command
      .add_option("--max-memory", listening.memory,
                  "memory of the process, as 2G, shared out to " + uses +
                      "; without it nine tenths of the control group's limit, or of the machine's memory")
      ->type_name("SIZE")
      ->check(CLI::Validator(is_size, "SIZE"))
      ->group("Limits");
}

void bound_memory(net::Limits& limits, const std::string& given) {
  // A tenth is left to what is not counted: the kernel's buffers of sockets and files, and gaps between the
  // pieces of malloc.
  constexpr double counted_share = 0.9;
  const std::uint64_t bytes =
      given.empty() ? static_cast<std::uint64_t>(counted_share * static_cast<double>(available_memory()))
                    : *memory_size(given);
  limits.scene.memory = MemoryBudget::of(std::max(bytes, MemoryBudget::least_bytes));
}

Status check_listening(const net::Options& options) {
  if (options.tls_certificate.empty() != options.tls_key.empty())
    return Error{"--tls-cert, --tls-key", "only one of them is given", "give both, or none"};
  for (const std::string& file : {options.tls_certificate, options.tls_key})
    if (!file.empty() && !std::filesystem::is_regular_file(file))
      return Error{file, "is not a file", "give a PEM file"};
  for (const std::string& proxy : options.trusted_proxies)
    if (!net::is_ip_address(proxy))
      return Error{"--trusted-proxy", "\"" + proxy + "\"", "an IPv4 or IPv6 address, e.g. 192.0.2.7"};
  return ok();
}

int listen_and_serve(Listening listening) {
  set_log_level(*log_level(listening.log_level));
  share_free_memory();
  fit_descriptors(listening.options.limits, listening.options.relay);
  StopOnSignal::block();
  Result<std::unique_ptr<net::Server>> server = net::Server::listen(std::move(listening.options));
  if (!server) return fail(server.error(), exit_internal);
  StopOnSignal stop(**server);
  const std::optional<session::Failed> failed =
      (*server)->run([&] { std::cout << "listening on " << (*server)->url() << std::endl; });
  stop.forget_server();
  server->reset();  // while `stop` lives, which ends the process if this call hangs
  if (!failed) return exit_done;
  return fail(failed->error, failed->no_opengl ? exit_no_opengl : exit_internal);
}

}  // namespace clothlab::cli
