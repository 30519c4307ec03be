// `clothlab serve`: a scene live in the browser, and for scripts over its WebSocket.
#include <csignal>
#include <filesystem>
#include <iostream>
#include <thread>

#include "server/cli/commands.h"
#include "server/model/model.h"
#include "server/net/log.h"
#include "server/net/server.h"

namespace clothlab::cli {

namespace {

struct ServeArguments {
  SceneChoice scene{"seed", {}};
  net::Options options;
  std::string asset_root;
  int gpu = -1;
};

/// Ends the server on SIGINT and SIGTERM, which must be blocked in every thread: this one waits for them.
class StopOnSignal {
 public:
  explicit StopOnSignal(net::Server& server)
      : thread_([&server] {
          const sigset_t signals = stop_signals();
          int received = 0;
          sigwait(&signals, &received);
          server.stop();
        }) {}
  ~StopOnSignal() {
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Before any thread is started.
  static void block() {
    const sigset_t signals = stop_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }

 private:
  static sigset_t stop_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    return signals;
  }
  std::thread thread_;
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
  if (!arguments.asset_root.empty() && !std::filesystem::is_directory(arguments.asset_root))
    return Error{"--asset-root " + arguments.asset_root, "is not a folder", "give a folder that exists"};
  return ok();
}

int serve(ServeArguments& arguments) {
  if (const Status checked = check(arguments); !checked) return fail(checked.error(), exit_usage);
  Result<scene::Document> document = arguments.scene.load();
  if (!document) return fail(document.error(), exit_usage);
  if (const Result<model::Model> model = model::build(document->scene); !model)
    return fail(model.error(), exit_usage);
  arguments.options.document = std::move(*document);
  if (arguments.gpu >= 0) arguments.options.gpu = arguments.gpu;
  StopOnSignal::block();
  Result<std::unique_ptr<net::Server>> server = net::Server::listen(std::move(arguments.options));
  if (!server) return fail(server.error(), exit_internal);
  const StopOnSignal stop(**server);
  const std::optional<net::Failed> failed =
      (*server)->run([&] { std::cout << "listening on " << (*server)->url() << std::endl; });
  if (!failed) return exit_done;
  return fail(failed->error, failed->no_opengl ? exit_no_opengl : exit_internal);
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
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_option("--token", options.token, "what operators must send first (auth), or as a Bearer token")
      ->type_name("T");
  command->add_option("--view-token", options.view_token, "the same for viewers, who change nothing")
      ->type_name("T");
  command
      ->add_option("--allow-origin", options.allow_origin,
                   "an origin whose pages may connect besides this server's own")
      ->type_name("ORIGIN")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--max-sessions", options.max_sessions, "scenes that run side by side (/?session=NAME)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--max-clients", options.max_clients, "connections, over all sessions")
      ->type_name("N")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--asset-root", arguments->asset_root,
                   "the folder for meshes a scene names; no scene can name one yet")
      ->type_name("FOLDER");
  command->add_option("--gpu", arguments->gpu, "the device by its number in `clothlab info`")
      ->type_name("N")
      ->check(CLI::Range(0, 1000));
  command->add_option("--tls-cert", options.tls_certificate, "PEM file; with --tls-key: HTTPS and WSS")
      ->type_name("FILE");
  command->add_option("--tls-key", options.tls_key, "PEM file")->type_name("FILE");
  command->footer(R"(Examples:
  clothlab serve                                              open http://127.0.0.1:8080
  clothlab serve --scene my-scene.json --port 0               on a free port
  clothlab serve --bind 0.0.0.0 --token SECRET --view-token PUBLIC

Prints "listening on http://..." when it accepts connections; Ctrl+C ends it.)");
  command->callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}

}  // namespace clothlab::cli
