// `clothlab relay`: shows sessions of other servers, which come over a message bus, to viewers.
#include <utility>

#include "server/cli/commands.h"
#include "server/cli/listening.h"

namespace clothlab::cli {

void add_relay(CLI::App& app, int& exit_code) {
  auto listening = std::make_shared<Listening>();
  net::Options& options = listening->options;
  options.relay = true;
  options.port = 8081;
  options.limits.clients = 10000;
  options.limits.clients_per_address = 256;
  options.limits.sessions = 64;
  options.limits.scene.unwatched_seconds = 5;  // a session that nobody watches here costs nothing to leave
  CLI::App* command = app.add_subcommand(
      "relay", "show sessions of `clothlab serve --publish` to many viewers, who change nothing");
  command
      ->add_option("--from", options.bus, "the NATS server on which they are published, as nats://HOST:PORT")
      ->type_name("URL")
      ->envname("CLOTHLAB_FROM")
      ->required();
  add_listening(*command, *listening, "");
  command
      ->add_option("--view-token", options.view_token,
                   "what viewers must send first (auth); without it everybody "
                   "may watch")
      ->type_name("T")
      ->envname("CLOTHLAB_VIEW_TOKEN");
  add_limit(*command, "--max-sessions", options.limits.sessions, 1, 1000,
            "sessions that are shown at the same time");
  add_memory_limit(*command, *listening, "what it shows and to what viewers have not read");
  add_connection_limits(*command, options.limits);
  command->footer(R"(Example, all on one machine:
  /usr/sbin/nats-server -a 127.0.0.1 &                 unless it runs already: apt-get install nats-server
  clothlab serve --publish nats://127.0.0.1:4222 &
  clothlab relay --from nats://127.0.0.1:4222          open http://127.0.0.1:8081

Prints "listening on http://..." when it accepts connections; Ctrl+C ends it.)");
  command->callback([listening, &exit_code] {
    const Status checked = check_listening(listening->options);
    if (!checked) {
      exit_code = fail(checked.error(), exit_usage);
      return;
    }
    bound_memory(listening->options.limits, listening->memory);
    exit_code = listen_and_serve(std::move(*listening));
  });
}

}  // namespace clothlab::cli
