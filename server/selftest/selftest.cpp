#include "server/selftest/selftest.h"

#include <algorithm>

#include "server/selftest/checks.h"

namespace clothlab::selftest {

namespace {

/// The run of this name; the scenes that come with the program have it.
const ShortRun& run_named(const std::vector<ShortRun>& runs, const std::string& name) {
  const auto found =
      std::find_if(runs.begin(), runs.end(), [&](const ShortRun& run) { return run.name == name; });
  return found == runs.end() ? runs.front() : *found;
}

constexpr const char* shown = "solids, verlet";  ///< drawn, and packed into frames
/// One dispatch a step, one work group, many dispatches; contact of both kinds.
constexpr const char* repeated[] = {"swing, symplectic_euler", "points, xpbd", "surface, vbd",
                                    "sheet, implicit_euler"};

}  // namespace

void run(Report& report, const Options& options) {
  const Result<std::vector<ShortRun>> runs = short_runs();
  if (!runs) return report.add(failed("scenes", runs.error()));
  check_programs(report, options.quick);
  for (const ShortRun& run : *runs)
    if (run.quick || !options.quick) report.make("scene: " + run.name, [&] { return check_scene(run); });
  for (const char* name : repeated) {
    const ShortRun& run = run_named(*runs, name);
    report.make("repeats: " + run.name, [&] { return check_repeats(run); });
  }
  check_frames(report, run_named(*runs, shown));
  report.make("picture", [&] { return check_picture(run_named(*runs, shown)); });
  tell_speed(report, options.quick);
}

Status write_places(const std::filesystem::path& folder) {
  const Result<std::vector<ShortRun>> runs = short_runs();
  if (!runs) return runs.error();
  for (const ShortRun& run : *runs) {
    if (run.has_reference) continue;
    const Result<Places> places = places_of(run);
    if (!places) return places.error();
    if (Status written = write_places_file(folder / run.places_file(), *places); !written) return written;
  }
  const Result<std::vector<double>> colours = colours_of(run_named(*runs, shown));
  return colours ? write_colours(folder / colours_file, *colours) : colours.error();
}

}  // namespace clothlab::selftest
