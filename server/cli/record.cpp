// `clothlab record S --time T --out F.html|F.clothlab`: records a simulation, alone or in a page that plays
// it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "server/base/text.h"
#include "server/cli/commands.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/stream/collider_text.h"
#include "server/stream/recording.h"

namespace clothlab::cli {

namespace {

constexpr double least_rate = 1, most_rate = 120;

struct RecordOptions {
  SceneChoice scene;
  double time = 0, rate = 30;  // [s], [1/s]
  std::string out;
  std::optional<int> gpu;
};

bool is_page(const std::string& path) {
  return std::filesystem::path(path).extension() == ".html";
}

Status check_options(const RecordOptions& options) {
  if (!is_page(options.out) && std::filesystem::path(options.out).extension() != ".clothlab")
    return Error{"--out " + options.out, "unknown kind of file",
                 "a file that ends in .html (plays in a browser) or .clothlab (the recording alone)"};
  if (!(options.rate >= least_rate && options.rate <= most_rate))
    return Error{"--rate", with_significant_digits(options.rate, 9), "1 to 120 frames a second"};
  if (is_page(options.out))  // before an hour of stepping, not after it
    if (const Result<std::string> page = stream::player_page("", ""); !page) return page.error();
  return check_writable("--out", options.out);
}

/// The steps from one frame to the next, with a note if they do not make the rate that was asked for.
std::uint64_t steps_a_frame(double rate, double dt) {
  const auto steps = static_cast<std::uint64_t>(std::max(1.0, std::round(1.0 / (rate * dt))));
  const double taken = 1.0 / (static_cast<double>(steps) * dt);
  if (std::abs(taken - rate) > 0.005 * rate)
    note("--rate " + with_significant_digits(rate, 9) + ": a frame every " + std::to_string(steps) +
         " steps of " + with_significant_digits(dt, 9) + " s, so " + with_significant_digits(taken, 3) +
         " a second");
  return steps;
}

nlohmann::json ending_of(const Progress& progress) {
  nlohmann::json ending{{"time", progress.state.time}, {"diverged", nullptr}};
  if (progress.diverged)
    ending["diverged"] = {{"reason", progress.setback.reason}, {"remedy", progress.setback.remedy.text}};
  return ending;
}

Status write(const RecordOptions& options, const std::string& recording, const std::string& title) {
  if (!is_page(options.out)) return write_file(options.out, recording);
  const Result<std::string> page = stream::player_page(recording, title);
  if (!page) return page.error();
  return write_file(options.out, *page);
}

int record_scene(const RecordOptions& options) {
  if (Status allowed = check_options(options); !allowed) return fail(allowed.error(), exit_usage);
  int exit_code = exit_done;
  const std::optional<Prepared> prepared = prepare(options.scene, options.gpu, exit_code);
  if (!prepared) return exit_code;
  sim::Simulation& simulation = *prepared->simulation;
  const double dt = simulation.scene().solver.dt;
  const Result<std::uint64_t> steps = whole_steps("--time", options.time, dt);
  if (!steps) return fail(steps.error(), exit_usage);
  const Result<scene::Document> document = options.scene.load();
  if (!document) return fail(document.error(), exit_usage);

  const std::uint64_t every = steps_a_frame(options.rate, dt);

  std::string bytes;
  stream::Recording recording([&](std::string_view more) { bytes += more; }, document->value,
                              1.0 / (static_cast<double>(every) * dt));
  recording.set_mesh(simulation.model(), simulation.scene());
  const auto add = [&](const sim::Diagnostics&) {
    const std::vector<glm::vec3> positions = simulation.read_state().position;
    recording.add(
        {simulation.time(), simulation.step_index(), 0, positions, stream::moving_colliders(simulation)});
    return ok();
  };
  const Result<Progress> progress = advance(*prepared, *steps, every, add);
  if (!progress) return fail(progress.error(), exit_internal);
  recording.finish(ending_of(*progress));
  if (Status written = write(options, bytes, simulation.scene().name); !written)
    return fail(written.error(), exit_internal);
  std::cout << options.out << ": " << recording.frames() << " frames of " << simulation.scene().name << ", "
            << progress->state.time << " s, " << std::filesystem::file_size(options.out) << " bytes\n";
  return exit_after(*progress);
}

}  // namespace

void add_record(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("record", "simulate and record: a page that plays in any browser, or the recording");
  const auto options = std::make_shared<RecordOptions>();
  options->scene.add_positional(*command);
  command->add_option("--time", options->time, "how long [s]; rounded to whole steps")
      ->required()
      ->type_name("T");
  command
      ->add_option("--out", options->out,
                   "the page that plays it without a server (.html), or the recording alone (.clothlab)")
      ->required()
      ->type_name("F");
  command->add_option("--rate", options->rate, "frames a second, in steps as whole as they come")
      ->type_name("N")
      ->capture_default_str();
  add_gpu(*command, options->gpu);
  command->footer("Example:\n  clothlab record seed --time 10 --out seed.html");
  command->callback([options, &exit_code] { exit_code = record_scene(*options); });
}

}  // namespace clothlab::cli
