// `clothlab sweep F --out DIR`: measures a scene along axes of its numbers, a share of the points at a time.
#include <chrono>
#include <iostream>
#include <memory>

#include "server/base/files.h"
#include "server/base/text.h"
#include "server/cli/commands.h"
#include "server/cli/long_job.h"
#include "server/cli/shard.h"
#include "server/cli/stepping.h"
#include "server/gl/context.h"
#include "server/lab/draw/plot.h"
#include "server/sweep/folder.h"
#include "server/sweep/measure.h"
#include "server/sweep/pictures.h"
#include "server/sweep/table.h"

namespace clothlab::cli {

namespace fs = std::filesystem;

namespace {

struct SweepOptions {
  std::string file, out, merge, shard = "1/1", asset_root;
  std::optional<int> gpu;
};

/// What a shard did.
struct Done {
  std::size_t measured = 0, skipped = 0, refused = 0;
  std::string first_refusal;
};

std::string in_words(const Done& done) {
  std::string words = lab::count(done.measured, "point") + " measured";
  if (done.skipped > 0) words += ", " + std::to_string(done.skipped) + " there before";
  if (done.refused > 0) words += ", " + std::to_string(done.refused) + " of them no valid scene";
  return words;
}

/// Measures the points of a shard that are not there yet.
Result<Done> measure(const sweep::Plan& plan, const sweep::Folder& folder, const Shard& shard,
                     const std::stop_token& stop, ProgressLine& line) {
  sweep::Measurement measurement(plan);
  Done done;
  const std::size_t size = plan.size();
  for (std::size_t point = shard.number - 1; point < size; point += shard.of) {
    if (stop.stop_requested()) return lab::cancelled;
    const std::string id = plan.id(point);
    line.show({static_cast<double>(point), static_cast<double>(size), plan.labels(point).dump()});
    if (folder.has(id)) {
      ++done.skipped;
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    sweep::Measured measured;
    const Result<scene::Document> scene = plan.scene(point);
    Result<sweep::Measured> found = scene ? measurement.measure(*scene, stop) : scene.error();
    if (found) {
      measured = std::move(*found);
    } else {
      if (!found.error().where.starts_with("/")) return found.error();
      measured.result["refused"] = found.error().text();
      if (++done.refused == 1) done.first_refusal = found.error().text();
    }
    measured.result["wall_s"] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (Status kept = folder.keep(id, measured); !kept) return kept.error();
    ++done.measured;
  }
  return done;
}

int run_sweep(const SweepOptions& options) {
  const Result<Shard> shard = shard_of(options.shard);
  if (!shard) return fail(shard.error(), exit_usage);
  const auto meshes = folder_of_meshes(options.asset_root, options.file);
  if (!meshes) return fail(meshes.error(), exit_usage);
  const Result<sweep::Plan> plan = sweep::read_plan(options.file, *meshes);
  if (!plan) return fail(plan.error(), exit_usage);
  const Result<sweep::Folder> folder = sweep::Folder::open(options.out, *plan);
  if (!folder) return fail(folder.error(), exit_usage);
  gl::compute_without_helper_threads();
  const StopOnInterrupt interrupt;
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(options.gpu);
  if (!context) return fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
  ProgressLine line;
  const Result<Done> done = measure(*plan, *folder, *shard, interrupt.token(), line);
  line.clear();
  if (!done && lab::was_cancelled(done.error())) {
    note("interrupted: what is measured is kept; the same command goes on from there");
    return exit_interrupted;
  }
  if (!done) return fail(done.error(), exit_internal);
  std::cout << plan->name << ", shard " << options.shard << " of " << lab::count(plan->size(), "point")
            << ": " << in_words(*done) << "\n";
  if (done->refused > 0) note("the first that is no valid scene: " + done->first_refusal);
  if (shard->of == 1)
    std::cout << "`clothlab sweep --merge " << options.out << "` makes tables and pictures of them\n";
  return exit_done;
}

/// ", chart.svg, map.svg", or how many there are.
std::string in_words(const std::vector<std::string>& pictures) {
  constexpr std::size_t most_named = 4;
  if (pictures.size() > most_named) return " and " + lab::count(pictures.size(), "picture") + " (*.svg)";
  std::string words;
  for (const std::string& name : pictures) words += ", " + name;
  return words;
}

int merge(const SweepOptions& options) {
  const auto meshes = folder_of_meshes(options.asset_root, options.merge + "/sweep.json");
  if (!meshes) return fail(meshes.error(), exit_usage);
  const Result<std::pair<sweep::Folder, sweep::Plan>> found = sweep::Folder::find(options.merge, *meshes);
  if (!found) return fail(found.error(), exit_usage);
  const sweep::Table table = sweep::table_of(found->first, found->second);
  const fs::path folder = options.merge;
  for (const auto& [name, text] : {std::pair{"table.csv", sweep::csv(table)},
                                   std::pair{"table.json", sweep::to_json(table).dump() + "\n"}})
    if (Status written = replace_file(folder / name, text); !written)
      return fail(written.error(), exit_internal);
  const sweep::Pictures pictures = sweep::pictures(found->second, table);
  std::vector<std::string> names;
  for (const sweep::Picture& picture : pictures.drawn) {
    if (Status written = replace_file(folder / picture.name, picture.svg); !written)
      return fail(written.error(), exit_internal);
    names.push_back(picture.name);
  }
  const Result<std::string> page = sweep::page(table, names);
  if (page) {
    if (Status written = replace_file(folder / "sweep.html", *page); !written)
      return fail(written.error(), exit_internal);
  } else {
    note("no page: " + page.error().text());
  }
  std::cout << table.name << ": " << table.rows.size() << " of " << lab::count(table.points, "point") << "\n"
            << "written: " << (folder / "table.csv").string() << ", table.json"
            << (page ? ", sweep.html" : "") << in_words(names) << "\n";
  if (pictures.beyond > 0)
    note(lab::count(pictures.beyond, "picture") +
         " more would be needed for all combinations of values; at most " +
         std::to_string(sweep::most_pictures) + " are drawn");
  if (table.missing > 0)
    note(lab::count(table.missing, "point is", "points are") +
         " not measured, or their files are damaged; the sweep's command measures them");
  return exit_done;
}

}  // namespace

void add_sweep(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("sweep", "measure a scene along axes of its numbers; in shards, on many machines");
  const auto options = std::make_shared<SweepOptions>();
  CLI::Option* file = command->add_option("file", options->file, "the sweep's file (.json)")->type_name("F");
  CLI::Option* out =
      command->add_option("--out", options->out, "the folder of the results; shards may share it")
          ->type_name("DIR");
  file->needs(out);
  command->add_option("--shard", options->shard, "measure every n-th point, from the i-th on")
      ->type_name("I/N")
      ->capture_default_str();
  command
      ->add_option("--merge", options->merge, "make tables and pictures of the results that are in a folder")
      ->type_name("DIR")
      ->excludes(file);
  add_asset_root(*command, options->asset_root);
  add_gpu(*command, options->gpu);
  command->footer(R"(Examples:
  clothlab sweep drop.json --out results
  clothlab sweep drop.json --out results --shard 3/8
  clothlab sweep --merge results

drop.json, for example (see server/sweep/README.md):
  {"scene": "hanging-strip", "measure": ["error", "cost", "crossings"], "axes": [
    {"at": "/solver/method", "values": ["verlet", "rk4"]},
    {"at": "/solver/dt", "from": 0.0002, "to": 0.004, "count": 6, "spacing": "log"}]}

A point whose result is in the folder is not measured again. Ctrl-C and SIGTERM keep what is measured; the exit
code is 130 then. A time of stepping counts only while nothing else works on the same cores, else it is left out.)");
  command->callback([options, &exit_code] {
    if (!options->merge.empty())
      exit_code = merge(*options);
    else if (options->file.empty())
      exit_code =
          fail({"sweep", "neither a file nor --merge", "`clothlab sweep --help` shows both"}, exit_usage);
    else
      exit_code = run_sweep(*options);
  });
}

}  // namespace clothlab::cli
