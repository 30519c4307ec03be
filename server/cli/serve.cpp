// `clothlab serve`: a scene live in the browser, and for scripts over its WebSocket.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <thread>
#include <utility>

#include "server/base/files.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/memory.h"
#include "server/cli/commands.h"
#include "server/gl/context.h"
#include "server/model/model.h"
#include "server/model/size.h"
#include "server/net/request_headers.h"
#include "server/net/server.h"

namespace clothlab::cli {

namespace {

struct ServeArguments {
  SceneChoice scene{"seed", {}};
  net::Options options;
  std::string log_level = "info";
  int gpu = -1;
};

/// Stops the server on SIGINT or SIGTERM. Both must be blocked in all threads: the thread made here waits for
/// them. The process exits by force if the server has not ended within 3 s (a driver may hang), and on a
/// second signal. Sessions are saved about once a second (with --state-dir), so at most the last second is
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

Status check(const ServeArguments& arguments) {
  const net::Options& options = arguments.options;
  if (!net::is_loopback(options.bind) && options.token.empty())
    return Error{"--bind " + options.bind, "anybody who reaches this machine could change the scene",
                 "set --token too, or bind to 127.0.0.1"};
  if (!options.view_token.empty() && options.token.empty())
    return Error{"--view-token", "given without --token", "set --token too: it is what operators need"};
  if (options.tls_certificate.empty() != options.tls_key.empty())
    return Error{"--tls-cert, --tls-key", "only one of them is given", "give both, or none"};
  for (const std::string& file : {options.tls_certificate, options.tls_key})
    if (!file.empty() && !std::filesystem::is_regular_file(file))
      return Error{file, "is not a file", "give a PEM file"};
  if (options.share_state && options.state_folder.empty())
    return Error{"--share-state-dir", "given without --state-dir", "name the folder that the servers share"};
  for (const std::string& proxy : options.trusted_proxies)
    if (!net::is_ip_address(proxy))
      return Error{"--trusted-proxy", "\"" + proxy + "\"", "an IPv4 or IPv6 address, e.g. 192.0.2.7"};
  return ok();
}

/// Makes the folder of --state-dir if needed, checks that it can be written, and locks it for as long as the
/// returned lock lives: two servers would overwrite each other's sessions, unless both share it.
Result<Lock> claim_state_folder(const net::Options& options) {
  if (options.state_folder.empty()) return Lock();
  std::error_code failure;
  std::filesystem::create_directories(options.state_folder, failure);
  Result<Lock> lock =
      Lock::folder(options.state_folder, options.share_state ? Lock::Kind::shared : Lock::Kind::exclusive);
  if (!lock)
    return Error{"--state-dir " + options.state_folder.string(), lock.error().what, lock.error().remedy};
  const std::filesystem::path trial = options.state_folder / "trial";
  if (const Status writable = replace_file(trial, ""); !writable)
    return Error{"--state-dir " + options.state_folder.string(), writable.error().what,
                 "give a folder that can be written"};
  std::filesystem::remove(trial, failure);
  return std::move(*lock);
}

int serve(ServeArguments& arguments) {
  if (const Status checked = check(arguments); !checked) return fail(checked.error(), exit_usage);
  const Result<std::shared_ptr<scene::FolderAssets>> assets = arguments.scene.assets();
  if (!assets) return fail(assets.error(), exit_usage);
  Result<scene::Document> document = arguments.scene.load(*assets);
  if (!document) return fail(document.error(), exit_usage);
  const net::Limits& limits = arguments.options.limits;
  if (const Status small =
          model::check_size(model::size_of(document->scene), static_cast<std::size_t>(limits.scene.vertices),
                            static_cast<std::size_t>(limits.scene.springs));
      !small)
    return fail(small.error(), exit_usage);
  if (const Result<model::Model> model = model::build(document->scene); !model)
    return fail(model.error(), exit_usage);
  const Result<Lock> state_folder = claim_state_folder(arguments.options);
  if (!state_folder) return fail(state_folder.error(), exit_usage);
  // Clients reach the files of a folder only if the user has named it.
  if (arguments.scene.asset_root.empty()) (*assets)->close();
  arguments.options.assets = *assets;
  arguments.options.document = std::move(*document);
  if (arguments.gpu >= 0) arguments.options.gpu = arguments.gpu;
  set_log_level(*log_level(arguments.log_level));
  share_free_memory();
  StopOnSignal::block();
  gl::compute_without_helper_threads();
  Result<std::unique_ptr<net::Server>> server = net::Server::listen(std::move(arguments.options));
  if (!server) return fail(server.error(), exit_internal);
  StopOnSignal stop(**server);
  const std::optional<session::Failed> failed =
      (*server)->run([&] { std::cout << "listening on " << (*server)->url() << std::endl; });
  stop.forget_server();
  server->reset();  // while `stop` lives, which ends the process if this call hangs
  if (!failed) return exit_done;
  return fail(failed->error, failed->no_opengl ? exit_no_opengl : exit_internal);
}

void add_limits(CLI::App& command, net::Limits& limits) {
  const auto add = [&](const char* flag, int& value, int least, int most, const char* help) {
    command.add_option(flag, value, help)
        ->type_name("N")
        ->check(whole_number(least, most))
        ->capture_default_str()
        ->group("Limits");
  };
  const net::Limits usual;
  add("--max-sessions", limits.sessions, 1, 1000, "scenes that run side by side (/?session=NAME)");
  add("--max-clients", limits.clients, 1, 100000, "WebSocket connections, over all sessions");
  add("--max-clients-per-address", limits.clients_per_address, 1, 100000,
      "WebSocket connections from one address; behind a proxy everybody has the proxy's");
  add("--max-message-bytes", limits.message_bytes, 1024, 8 << 20, "bytes in one message to the server");
  add("--max-message-rate", limits.message_rate, 10, 1000000,
      "messages a second from one client, twice that in a burst");
  add("--max-json-depth", limits.json_depth, 8, usual.json_depth, "levels of nesting in a message");
  add("--max-vertices", limits.scene.vertices, 4, usual.scene.vertices, "vertices in a scene");
  add("--max-springs", limits.scene.springs, 4, usual.scene.springs, "springs in a scene");
  add("--max-recording-bytes", limits.scene.recording_bytes, 10000, 1 << 30,
      "bytes of a recording, of which each session keeps one in memory");
  add("--max-lab-seconds", limits.lab_seconds, 1, 86400, "seconds that one measurement of the lab may take");
  add("--header-timeout", limits.header_seconds, 1, 3600,
      "seconds from connecting to the last of a request's headers, TLS included");
  add("--auth-timeout", limits.auth_seconds, 1, 3600, "seconds until a client's token must have come");
  add("--max-wrong-tokens", limits.wrong_tokens, 1, 1000000,
      "wrong tokens a minute from one address; after that its tokens are refused for a while");
  add("--idle-timeout", limits.idle_seconds, 2, 3600,
      "seconds after which a connection that says nothing, not even pong, is closed");
  add("--unwatched-timeout", limits.scene.unwatched_seconds, 1, 86400,
      "seconds without viewers after which a session stops stepping, and may be closed to make room for a "
      "new one");
}

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ServeArguments>();
  net::Options& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("serve", "show a scene live in the browser, and to scripts over its WebSocket");
  arguments->scene.add_option(*command);
  command->add_option("--bind", options.bind, "the address to listen on; beyond loopback only with --token")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_option("--port", options.port, "the port to listen on; 0 picks a free one")
      ->type_name("PORT")
      ->check(whole_number(0, 65535))
      ->capture_default_str();
  // Tokens may come from the environment: other users of the machine can read only the command line.
  command->add_option("--token", options.token, "what operators must send first (auth), or as a Bearer token")
      ->type_name("T")
      ->envname("CLOTHLAB_TOKEN");
  command->add_option("--view-token", options.view_token, "the same for viewers, who change nothing")
      ->type_name("T")
      ->envname("CLOTHLAB_VIEW_TOKEN");
  command
      ->add_option(
          "--allow-origin", options.allow_origin,
          "an origin whose pages may connect, and show the page in a frame, besides this server's own; "
          "its host is one that this server answers as")
      ->type_name("ORIGIN")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_limits(*command, options.limits);
  command
      ->add_option("--state-dir", options.state_folder,
                   "a folder that keeps each session's scene and state, and brings them back after a restart")
      ->type_name("FOLDER");
  command->add_flag("--share-state-dir", options.share_state,
                    "other servers use that folder, too; each session is open in one of them at a time");
  command
      ->add_option("--trusted-proxy", options.trusted_proxies,
                   "the address of a proxy whose X-Forwarded-For says where a connection comes from")
      ->type_name("ADDRESS")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--gpu", arguments->gpu, "the device by its number in `clothlab info`")
      ->type_name("N")
      ->check(whole_number(0, 1000));
  command->add_option("--tls-cert", options.tls_certificate, "PEM file; with --tls-key: HTTPS and WSS")
      ->type_name("FILE");
  command->add_option("--tls-key", options.tls_key, "PEM file")->type_name("FILE");
  command->add_option("--log-level", arguments->log_level, "the least urgent events that are logged")
      ->type_name("error|warning|info|debug")
      ->check(CLI::IsMember({"error", "warning", "info", "debug"}))
      ->capture_default_str();
  command->footer(R"(Examples:
  clothlab serve                                              open http://127.0.0.1:8080
  clothlab serve --scene my-scene.json --port 0               on a free port
  clothlab serve --bind 0.0.0.0 --token SECRET --view-token PUBLIC

Prints "listening on http://..." when it accepts connections; Ctrl+C ends it.)");
  command->callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}

}  // namespace clothlab::cli
