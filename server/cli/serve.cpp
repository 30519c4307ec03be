// `clothlab serve`: a scene live in the browser, and for scripts over its WebSocket.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "server/base/files.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/cli/commands.h"
#include "server/cli/listening.h"
#include "server/gl/context.h"
#include "server/gl/gpus.h"
#include "server/model/model.h"
#include "server/model/size.h"
#include "server/net/server.h"
#include "server/sim/memory.h"

namespace clothlab::cli {

namespace {

struct ServeArguments {
  SceneChoice scene{"seed", {}};
  bool scene_named = false;  ///< on the command line
  Listening listening;
  int gpu = -1;
};

/// Says so if not all sessions that may be opened have room, with the scene that each starts with.
void warn_of_memory(const net::Limits& limits, const scene::Scene& scene) {
  const std::uint64_t share = limits.scene.memory->share(MemoryBudget::Use::simulations),
                      each = sim::expected_memory(scene), room = share / each;
  if (room >= static_cast<std::uint64_t>(limits.sessions)) return;
  log(LogLevel::warning, "limit_not_kept",
      {{"limit", "--max-sessions"},
       {"of", std::to_string(limits.sessions)},
       {"holds", std::to_string(room)},
       {"why", "a session of this scene takes " + memory_text(each) + " of memory, and all may take " +
                   memory_text(share) + "; more are refused when they open"},
       {"remedy", "a larger --max-memory, a smaller scene, or a smaller --max-sessions"}});
}

Status check(const net::Options& options) {
  if (!net::is_loopback(options.bind) && options.token.empty())
    return Error{"--bind " + options.bind, "anybody who reaches this machine could change the scene",
                 "set --token too, or bind to 127.0.0.1"};
  if (!options.view_token.empty() && options.token.empty())
    return Error{"--view-token", "given without --token", "set --token too: it is what operators need"};
  if (options.share_state && options.state_folder.empty())
    return Error{"--share-state-dir", "given without --state-dir", "name the folder that the servers share"};
  return check_listening(options);
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

/// Names GPUs that are in the machine and that OpenGL does not offer: else the server is slow without a word
/// why.
void warn_of_gpus() {
  if (gl::gpus_without_opengl({}).empty()) return;  // no GPU: the devices need not be opened
  const Result<std::vector<gl::Device>> devices = gl::list_devices();
  if (devices && std::any_of(devices->begin(), devices->end(),
                             [](const gl::Device& of) { return of.usable && !of.software; }))
    return;
  for (const std::string& gpu : gl::gpus_without_opengl(devices ? *devices : std::vector<gl::Device>()))
    log(LogLevel::warning, "gpu_without_opengl", {{"why", gpu}});
}

int serve(ServeArguments& arguments) {
  net::Options& options = arguments.listening.options;
  if (const Status checked = check(arguments.listening.options); !checked)
    return fail(checked.error(), exit_usage);
  const Result<std::shared_ptr<scene::FolderAssets>> assets = arguments.scene.assets();
  if (!assets) return fail(assets.error(), exit_usage);
  Result<scene::Document> document = arguments.scene.load(*assets);
  if (!document) return fail(document.error(), exit_usage);
  if (Status large = scene::check_bytes(document->value); !large)
    return fail({arguments.scene.name, large.error().what, large.error().remedy}, exit_usage);
  const net::Limits& limits = options.limits;
  if (const Status small =
          model::check_size(model::size_of(document->scene), static_cast<std::size_t>(limits.scene.vertices),
                            static_cast<std::size_t>(limits.scene.springs));
      !small)
    return fail(small.error(), exit_usage);
  bound_memory(options.limits, arguments.listening.memory);
  const std::uint64_t past = limits.scene.memory->share(MemoryBudget::Use::timelines);
  options.limits.scene.past_bytes = std::min(
      limits.scene.past_bytes, static_cast<std::size_t>(past / static_cast<std::uint64_t>(limits.sessions)));
  if (const auto place = sim::reserve_memory(limits.scene.memory, document->scene); !place)
    return fail(place.error(), exit_usage);
  set_log_level(*log_level(arguments.listening.log_level));
  warn_of_memory(limits, document->scene);
  if (const Result<model::Model> model = model::build(document->scene); !model)
    return fail(model.error(), exit_usage);
  const Result<Lock> state_folder = claim_state_folder(options);
  if (!state_folder) return fail(state_folder.error(), exit_usage);
  // Clients reach the files of a folder only if the user has named it.
  if (arguments.scene.asset_root.empty()) (*assets)->close();
  options.assets = *assets;
  options.document = std::move(*document);
  options.usual_scene = !arguments.scene_named && arguments.scene.set.empty();
  if (arguments.gpu >= 0) options.gpu = arguments.gpu;
  gl::compute_without_helper_threads();
  warn_of_gpus();
  return listen_and_serve(std::move(arguments.listening));
}

void add_session_limits(CLI::App& command, net::Limits& limits) {
  const auto add = [&](const char* flag, int& value, int least, int most, const char* help) {
    add_limit(command, flag, value, least, most, help);
  };
  const net::Limits usual;
  add("--max-sessions", limits.sessions, 1, 1000, "scenes that run side by side (/?session=NAME)");
  add("--max-vertices", limits.scene.vertices, 4, usual.scene.vertices, "vertices in a scene");
  add("--max-springs", limits.scene.springs, 4, usual.scene.springs, "springs in a scene");
  add("--max-recording-bytes", limits.scene.recording_bytes, 10000, 1 << 30,
      "bytes of a recording, of which each session keeps one in memory");
  add("--max-lab-seconds", limits.lab_seconds, 1, 86400, "seconds that one measurement of the lab may take");
  add("--unwatched-timeout", limits.scene.unwatched_seconds, 1, 86400,
      "seconds without viewers after which a session stops stepping, and may be closed to make room for a "
      "new one");
}

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ServeArguments>();
  net::Options& options = arguments->listening.options;
  CLI::App* command =
      app.add_subcommand("serve", "show a scene live in the browser, and to scripts over its WebSocket");
  arguments->scene.add_option(*command);
  add_listening(*command, arguments->listening, "; beyond loopback only with --token");
  // Tokens may come from the environment: other users of the machine can read only the command line.
  command->add_option("--token", options.token, "what operators must send first (auth), or as a Bearer token")
      ->type_name("T")
      ->envname("CLOTHLAB_TOKEN");
  command->add_option("--view-token", options.view_token, "the same for viewers, who change nothing")
      ->type_name("T")
      ->envname("CLOTHLAB_VIEW_TOKEN");
  command
      ->add_option("--state-dir", options.state_folder,
                   "a folder that keeps each session's scene and state, and brings them back after a restart")
      ->type_name("FOLDER");
  command->add_flag("--share-state-dir", options.share_state,
                    "other servers use that folder, too; each session is open in one of them at a time");
  command
      ->add_option("--publish", options.bus,
                   "a NATS server, as nats://HOST:PORT, on which sessions are published for `clothlab relay`")
      ->type_name("URL")
      ->envname("CLOTHLAB_PUBLISH");
  command->add_option("--gpu", arguments->gpu, "the device by its number in `clothlab info`")
      ->type_name("N")
      ->check(whole_number(0, 1000));
  add_session_limits(*command, options.limits);
  add_memory_limit(*command, arguments->listening, "scenes, recordings and downloads");
  add_connection_limits(*command, options.limits);
  command->footer(R"(Examples:
  clothlab serve                                              open http://127.0.0.1:8080
  clothlab serve --scene my-scene.json --port 0               on a free port
  clothlab serve --bind 0.0.0.0 --token SECRET --view-token PUBLIC

Prints "listening on http://..." when it accepts connections; Ctrl+C ends it.)");
  command->callback([arguments, command, &exit_code] {
    arguments->scene_named = command->count("--scene") > 0;
    exit_code = serve(*arguments);
  });
}

}  // namespace clothlab::cli
