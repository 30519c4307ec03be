// `clothlab record S|R.clothlab [--time T] --out F`: records a simulation, or takes a recording, and writes
// it alone, in a page that plays it, or as a file for other programs.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "server/base/files.h"
#include "server/base/mapped_file.h"
#include "server/base/text.h"
#include "server/cli/commands.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/film/cut.h"
#include "server/film/formats.h"
#include "server/stream/collider_text.h"
#include "server/stream/recording.h"

namespace clothlab::cli {

namespace {

namespace fs = std::filesystem;

constexpr double least_rate = 1, most_rate = 120, usual_rate = 30;
constexpr std::uint64_t large =
    256u << 20;  ///< a file of which the size is told before it is written [bytes]

struct RecordOptions {
  SceneChoice scene;
  std::optional<double> time, rate;  // [s], [1/s]
  std::string out;
  std::optional<int> gpu;

  std::string ending() const { return fs::path(out).extension().string(); }
  bool of_recording() const { return fs::path(scene.name).extension() == ".clothlab"; }
};

Status check_options(const RecordOptions& options) {
  const std::string ending = options.ending();
  if (ending != ".html" && ending != ".clothlab" && !film::is_film(ending))
    return Error{
        "--out " + options.out, "unknown kind of file",
        "a file that ends in .html (plays in a browser), .clothlab (the recording alone), .glb, .usda or "
        ".pc2 (for other programs), or .obj (a file a frame)"};
  if (options.rate && !(*options.rate >= least_rate && *options.rate <= most_rate))
    return Error{"--rate", with_significant_digits(*options.rate, 9), "1 to 120 frames a second"};
  if (options.time && !(*options.time >= 0.0 && std::isfinite(*options.time)))
    return Error{"--time", with_significant_digits(*options.time, 9), "a time in seconds, 0 or more"};
  if (!options.of_recording() && !options.time)
    return Error{"--time", "not given",
                 "how long the scene is simulated [s]; only of a recording all is taken"};
  if (options.of_recording() && !options.scene.set.empty())
    return Error{"--set " + options.scene.set.front(), "nothing is simulated of a recording",
                 "a scene in its place"};
  if (options.of_recording() && options.rate && !film::is_film(ending))
    return Error{"--rate", "a recording keeps its own where it stays one",
                 "a film: .glb, .usda, .pc2 or .obj"};
  if (ending == ".html")  // before an hour of stepping, not after it
    if (const Result<std::string> page = stream::player_page("", ""); !page) return page.error();
  if (ending == ".pc2")
    if (Status beside = check_writable("--out", film::mesh_beside(options.out)); !beside) return beside;
  std::error_code none;
  if (options.of_recording() && fs::equivalent(options.scene.name, options.out, none))
    return Error{"--out " + options.out, "it is the recording itself", "another file"};
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

/// Says how large the file will be, if that is much. Error: it would be larger than it can be.
Status announce(const RecordOptions& options, std::uint64_t frames, std::uint64_t vertices) {
  if (Status fits = film::check_size(options.ending(), frames, vertices); !fits) return fits;
  const film::Format* format = film::format_of(options.ending());
  if (const std::uint64_t bytes = format ? format->bytes(frames, vertices) : 0; bytes > large)
    note(options.out + " will have about " + with_significant_digits(1e-9 * static_cast<double>(bytes), 2) +
         " GB");
  return ok();
}

nlohmann::json ending_of(const Progress& progress) {
  nlohmann::json ending{{"time", progress.state.time}, {"diverged", nullptr}};
  if (progress.diverged)
    ending["diverged"] = {{"reason", progress.setback.reason}, {"remedy", progress.setback.remedy.text}};
  return ending;
}

void tell(const std::string& names, std::uint32_t frames, const std::string& title, double seconds,
          std::uint64_t bytes) {
  std::cout << names << ": " << frames << " frames of " << title << ", " << seconds << " s, " << bytes
            << " bytes\n";
}

/// An error in the recording that is read, with the name of its file.
Error in_file(const RecordOptions& options, Error error) {
  if (options.of_recording()) error.where = options.scene.name + ", " + error.where;
  return error;
}

/// Says so if a recording ends [s], by a frame or more, before the time that was asked for.
void tell_early_end(const RecordOptions& options, std::uint32_t frames, double end) {
  if (options.of_recording() && options.time && *options.time >= end + end / std::max(1U, frames - 1))
    note("--time " + with_significant_digits(*options.time, 9) + ": the recording ends at " +
         with_significant_digits(end, 9) + " s");
}

/// Makes the file for other programs of a recording.
Status write_film(const RecordOptions& options, std::string_view recording) {
  // Of a scene the recording has what was asked for.
  const Result<film::Film> film = film::Film::of(
      recording, options.of_recording() ? film::Choice{options.time, options.rate} : film::Choice{});
  if (!film) return in_file(options, film.error());
  if (options.of_recording())
    if (Status fits = announce(options, film->frames(), film->vertex_count()); !fits) return fits;
  const Result<film::Written> written = film::write_files(*film, options.out);
  if (!written) return written.error();
  tell(written->names, film->frames(), film->title, film->times.back(), written->bytes);
  tell_early_end(options, film->frames(), film->times.back());
  return ok();
}

/// A file that is written beside the one that is asked for, and goes away if nobody renames it.
class Beside {
 public:
  explicit Beside(const std::string& out) : path_(out + unfinished_suffix), file_(path_, std::ios::binary) {}
  ~Beside() {
    std::error_code failure;
    fs::remove(path_, failure);
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  void put(std::string_view bytes) { file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); }
  Status close() {
    file_.close();
    return file_ ? ok() : Status(problem());
  }
  Status rename_to(const std::string& out) const {
    std::error_code failure;
    fs::rename(path_, out, failure);
    return failure ? Status(problem()) : ok();
  }
  const std::string& path() const { return path_; }

 private:
  Error problem() const {
    return {path_, "could not be written", "check the disk's space and the folder's permissions"};
  }
  std::string path_;
  std::ofstream file_;
};

/// Makes a page, or a file for other programs, of the recording in a file; or renames it.
Status deliver(const RecordOptions& options, const Beside& recorded, const std::string& title,
               std::uint32_t frames, double seconds) {
  if (options.ending() == ".clothlab") {
    if (Status renamed = recorded.rename_to(options.out); !renamed) return renamed;
  } else {
    const Result<MappedFile> file = MappedFile::open(recorded.path());
    if (!file) return file.error();
    if (film::is_film(options.ending())) return write_film(options, file->bytes());
    const Result<std::string> page = stream::player_page(file->bytes(), title);
    if (!page) return page.error();
    if (Status written = write_file(options.out, *page); !written) return written;
  }
  tell(options.out, frames, title, seconds, fs::file_size(options.out));
  return ok();
}

int record_scene(const RecordOptions& options) {
  int exit_code = exit_done;
  const std::optional<Prepared> prepared = prepare(options.scene, options.gpu, exit_code);
  if (!prepared) return exit_code;
  sim::Simulation& simulation = *prepared->simulation;
  const double dt = simulation.scene().solver.dt;
  const Result<std::uint64_t> steps = whole_steps("--time", *options.time, dt);
  if (!steps) return fail(steps.error(), exit_usage);
  const Result<scene::Document> document = options.scene.load();
  if (!document) return fail(document.error(), exit_usage);

  const std::uint64_t every = steps_a_frame(options.rate.value_or(usual_rate), dt);
  const std::uint64_t frames = (*steps + every - 1) / every + 1;
  if (Status fits = announce(options, frames, simulation.model().vertex_count()); !fits)
    return fail(fits.error(), exit_usage);

  Beside file(options.out);
  stream::Recording recording([&](std::string_view more) { file.put(more); }, document->value,
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
  Status done = file.close();
  if (done) {
    done = deliver(options, file, simulation.scene().name, recording.frames(), progress->state.time);
    // What took long to simulate is not lost with a film that could not be made.
    const std::string kept = options.out + ".clothlab";
    if (!done && file.rename_to(kept)) note("the recording is kept: " + kept);
  }
  if (!done) return fail(done.error(), exit_internal);
  return exit_after(*progress);
}

/// A recording that stays one: all of it, or its beginning, alone or in a page.
Status record_again(const RecordOptions& options, std::string_view recording) {
  Beside file(options.out);
  const Result<film::Kept> kept = film::cut(
      recording, options.time.value_or(std::numeric_limits<double>::infinity()), [&](std::string_view more) {
        file.put(more);
        return ok();
      });
  if (!kept) return in_file(options, kept.error());
  if (Status closed = file.close(); !closed) return closed;
  tell_early_end(options, kept->frames, kept->seconds);
  return deliver(options, file, kept->title, kept->frames, kept->seconds);
}

int record(const RecordOptions& options) {
  if (Status allowed = check_options(options); !allowed) return fail(allowed.error(), exit_usage);
  if (!options.of_recording()) return record_scene(options);
  const Result<MappedFile> file = MappedFile::open(options.scene.name);
  if (!file) return fail(file.error(), exit_usage);
  const Status done = film::is_film(options.ending()) ? write_film(options, file->bytes())
                                                      : record_again(options, file->bytes());
  return done ? exit_done : fail(done.error(), exit_usage);
}

}  // namespace

void add_record(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "record", "simulate and record, or take a recording: a page that plays, or a film for other programs");
  const auto options = std::make_shared<RecordOptions>();
  options->scene.add_positional(*command);
  command->get_option("scene")->description("a preset's name, a scene file, or a recording (.clothlab)");
  command
      ->add_option("--time", options->time,
                   "how long [s], of a scene rounded to whole steps; of a recording at most, else all of it")
      ->type_name("T");
  command
      ->add_option(
          "--out", options->out,
          "the page that plays it without a server (.html), the recording alone (.clothlab), a film with "
          "bodies (.glb, .usda), the vertices' places (.pc2, with the mesh as .obj beside it), or a mesh a "
          "frame (.obj: F-0000.obj, ...)")
      ->required()
      ->type_name("F");
  command
      ->add_option(
          "--rate", options->rate,
          "frames a second, in steps as whole as they come: 30; of a recording so many at most, else "
          "all")
      ->type_name("N");
  add_gpu(*command, options->gpu);
  command->footer(R"(Examples:
  clothlab record seed --time 10 --out seed.html
  clothlab record seed.clothlab --time 4 --out seed.glb)");
  command->callback([options, &exit_code] { exit_code = record(*options); });
}

}  // namespace clothlab::cli
