// `clothlab run S --time T`: steps a scene as fast as it goes and writes meshes, a trace and a report.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "server/base/text.h"
#include "server/cli/commands.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/gl/buffer.h"
#include "server/model/near_start.h"
#include "server/scene/method.h"
#include "server/sim/convergence.h"
#include "server/sim/crossing_check.h"
#include "server/sim/plan.h"

namespace clothlab::cli {

namespace {

using Report = nlohmann::ordered_json;

struct RunOptions {
  SceneChoice scene;
  double time = 0;  // [s]
  std::string out, trace, report;
  std::optional<double> every;  // [s]
  bool verify = false;
  std::optional<int> gpu;
};

constexpr double default_every = 0.01;  // [s], between two rows of a trace, or two states to verify

/// The `--trace` file. Each row is written at once, so that a run that ends early leaves the rows so far.
class Trace {
 public:
  explicit Trace(const std::string& path) : path_(path), file_(path) {
    file_ << "time,kinetic,elastic,gravitational,max_strain,max_speed,contacts,residual,error_m\n";
  }
  Status add(const sim::Diagnostics& state, const sim::Convergence& convergence) {
    for (const double value :
         {state.time, state.kinetic, state.elastic, state.gravitational, state.max_strain, state.max_speed})
      file_ << with_significant_digits(value, 9) << ',';
    file_ << state.contacts << ',';
    if (convergence.measured > 0)
      file_ << with_significant_digits(convergence.residual, 9) << ','
            << with_significant_digits(convergence.error, 9) << '\n';
    else
      file_ << ",\n";
    file_ << std::flush;
    if (!file_)
      return Error{path_, "could not be written", "check the disk's space and the file's permissions"};
    return ok();
  }
  void mark_diverged(double time) {
    file_ << "# diverged by " << with_significant_digits(time, 9) << " s\n" << std::flush;
  }

 private:
  std::string path_;
  std::ofstream file_;
};

Report device_report(const gl::Device& device) {
  return {{"index", device.index},   {"name", device.name}, {"version", device.version},
          {"vendor", device.vendor}, {"node", device.node}, {"software", device.software}};
}

Report make_report(const Prepared& prepared, const Progress& progress, double wall_seconds,
                   const sim::State& state) {
  const sim::Simulation& simulation = *prepared.simulation;
  const std::uint32_t vertices = simulation.model().vertex_count();
  const double vertex_steps = static_cast<double>(vertices) * static_cast<double>(progress.steps);
  Report report{{"version", CLOTHLAB_VERSION}, {"scene", simulation.scene().name}};
  report["renderer"] = prepared.context->device().name;
  report["device"] = device_report(prepared.context->device());
  report["vertices"] = vertices;
  report["memory_bytes"] = gl::buffer_bytes();
  report["method"] = scene::name(simulation.scene().solver.method);
  report["dt"] = simulation.scene().solver.dt;
  if (!prepared.chosen.empty()) report["chosen"] = prepared.chosen;
  report["steps"] = progress.state.step;
  report["sim_time"] = progress.state.time;
  report["wall_s"] = wall_seconds;
  report["step_s"] = progress.step_seconds;
  report["ns_per_vertex_step"] = vertex_steps > 0 ? 1e9 * progress.step_seconds / vertex_steps : 0.0;
  report["passes"] = Report::array();
  report["terms"] = Report::array();
  report["skipped"] = Report::object();
  for (const sim::Simulation::Part& part : simulation.parts()) {
    if (!part.skipped.empty())
      report["skipped"][part.name] = part.skipped;
    else
      report[part.kind == sim::Simulation::Part::Kind::pass ? "passes" : "terms"].push_back(part.name);
  }
  if (const sim::SolverWork work = simulation.solver_work(); work.newton_steps > 0)
    report["solver"] = {{"newton_steps", work.newton_steps},
                        {"linear_iterations", work.linear_iterations},
                        {"unconverged", work.unconverged}};
  report["convergence"] = nullptr;
  if (const sim::Convergence& of = simulation.convergence(); of.measured > 0)
    report["convergence"] = {{"residual", of.residual},     {"error_m", of.error},
                             {"tolerance_m", of.tolerance}, {"largest_error_m", of.largest_error},
                             {"measured", of.measured},     {"unsolved", of.unsolved_steps}};
  if (const sim::StrainLimitWork work = simulation.strain_limit_work(); work.sweeps > 0)
    report["strain_limit"] = {{"sweeps", work.sweeps}, {"unconverged", work.unconverged}};
  if (simulation.scene().collides(scene::ContactKind::points))
    report["self_collision"] = {{"neighbours_dropped", progress.state.neighbours_dropped}};
  const Report surface{{"pairs", progress.state.surface_pairs},
                       {"cuts", progress.state.surface_cuts},
                       {"forced", progress.state.surface_forced},
                       {"not_taken", progress.state.surface_not_taken},
                       {"searches", progress.state.surface_searches}};
  if (simulation.scene().collides(scene::ContactKind::surface)) report["self_collision"] = surface;
  if (progress.state.surface_searches > 0)
    report["surface"] = surface;  // also with bodies of triangles alone
  report["max_strain"] = progress.state.max_strain;
  report["energy"] = {{"kinetic", progress.state.kinetic},
                      {"elastic", progress.state.elastic},
                      {"gravitational", progress.state.gravitational}};
  report["diverged"] = progress.diverged;
  if (progress.diverged) {
    report["diverged_by"] = progress.diverged_by;
    report["diverged_reason"] = progress.setback.reason;
  }
  report["state_hash"] = formatted("%016llx", static_cast<unsigned long long>(sim::state_hash(state)));
  return report;
}

void print_summary(const Report& report, double simulated) {
  const double step_seconds = report["step_s"];
  std::printf("%s: %llu steps to %s s, stepping took %s s", report["scene"].get<std::string>().c_str(),
              static_cast<unsigned long long>(report["steps"].get<std::uint64_t>()),
              with_significant_digits(report["sim_time"], 9).c_str(),
              with_significant_digits(step_seconds, 9).c_str());
  if (step_seconds > 0)
    std::printf(" (%s times real time, %.1f ns per vertex and step)",
                with_significant_digits(simulated / step_seconds, 2).c_str(),
                report["ns_per_vertex_step"].get<double>());
  std::printf("\nlargest strain at the end %s, state %s, on %s\n",
              with_significant_digits(report["max_strain"], 9).c_str(),
              report["state_hash"].get<std::string>().c_str(), report["renderer"].get<std::string>().c_str());
  std::fflush(stdout);
}

/// Prints notes on stderr about neighbours left out of self-collision, what moves by itself and had no room,
/// linear solves that missed their tolerance and springs beyond their strain limit.
void print_shortcomings(const sim::Simulation& simulation, const sim::Diagnostics& state) {
  if (state.neighbours_dropped > 0)
    note("self-collision left out " + std::to_string(state.neighbours_dropped) +
         " neighbours, counted at each search, that had no room in a vertex's list: a smaller thickness or a "
         "coarser mesh helps");
  if (state.surface_not_taken > 0)
    note(std::to_string(state.surface_not_taken) +
         " steps were not taken, or not to their end, as more pairs of triangles and edges could meet than "
         "any list has room for: a coarser mesh, a smaller dt or a slower motion helps");
  // A start that is too near has been told before the first step, and is the cause if nothing moves by
  // itself.
  const bool from_start = sim::moving_motions(simulation.scene()).empty() &&
                          !model::near_start_warning(simulation.model(), simulation.scene()).empty();
  const std::uint32_t forced = state.surface_forced - state.surface_not_taken;
  if (forced > 0 && !from_start)
    note("pins or bodies pressed cloth where it cannot go, " + std::to_string(forced) +
         " times: a pin waited until there was room, and a body may have passed through what was in its way; "
         "slower or smaller motions help");
  if (const std::uint64_t solves = simulation.solver_work().unconverged; solves > 0)
    note(std::to_string(solves) +
         " linear solves ended before they met solver.tolerance, or steps before contact was solved; a "
         "smaller dt or a larger tolerance helps");
  if (simulation.convergence().often_unsolved())
    note(sim::in_words(simulation.convergence(), simulation.scene()));
  if (const std::uint64_t steps = simulation.strain_limit_work().unconverged; steps > 0)
    note(std::to_string(steps) +
         " steps ended with a spring or thread longer than its strain_limit; a smaller dt or a larger limit "
         "helps");
}

/// The files of --out and --trace, if given.
struct Outputs {
  std::optional<StateFiles> states;
  std::optional<Trace> trace;
};

/// Checks every option that names a file, before anything is simulated. `run` opens the trace later.
Result<Outputs> open_outputs(const RunOptions& options) {
  if (options.every && options.out.empty() && options.trace.empty() && !options.verify)
    return Error{"--every", with_significant_digits(*options.every, 9), "needs --out, --trace or --verify"};
  Outputs outputs;
  if (!options.out.empty()) {
    Result<StateFiles> states = StateFiles::create(options.out, options.every.has_value());
    if (!states) return states.error();
    outputs.states = std::move(*states);
  }
  for (const auto& [option, path] :
       {std::pair{"--trace", options.trace}, std::pair{"--report", options.report}})
    if (!path.empty())
      if (Status writable = check_writable(option, path); !writable) return writable.error();
  return outputs;
}

std::string comment(const sim::Diagnostics& state, const std::string& scene, bool diverged) {
  return "Clothlab " CLOTHLAB_VERSION ", scene " + scene + " at " + with_significant_digits(state.time, 9) +
         " s, in metres" + (diverged ? "; the simulation diverged after this" : "");
}

/// The steps between two stops: those of --every; else default_every if there is a trace or states are
/// verified; else all `steps`.
Result<std::uint64_t> stop_interval(const RunOptions& options, std::uint64_t steps, double dt) {
  if (!options.every && options.trace.empty() && !options.verify) return std::max<std::uint64_t>(steps, 1);
  if (!options.every)
    return std::max<std::uint64_t>(static_cast<std::uint64_t>(std::llround(default_every / dt)), 1);
  if (*options.every < dt / 2)
    return Error{"--every", with_significant_digits(*options.every, 9),
                 "one step (" + with_significant_digits(dt, 9) + " s) or more"};
  return whole_steps("--every", *options.every, dt);
}

int run(const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  Result<Outputs> outputs = open_outputs(options);
  if (!outputs) return fail(outputs.error(), exit_usage);
  // However this run ends, its report and trace are never those of another one.
  for (const std::string& path : {options.report, options.trace}) remove_older(path);
  int exit_code = exit_done;
  const std::optional<Prepared> prepared = prepare(options.scene, options.gpu, exit_code);
  if (!prepared) return exit_code;
  sim::Simulation& simulation = *prepared->simulation;
  const std::string scene_name = simulation.scene().name;
  const double dt = simulation.scene().solver.dt;
  const Result<std::uint64_t> steps = whole_steps("--time", options.time, dt);
  if (!steps) return fail(steps.error(), exit_usage);
  const Result<std::uint64_t> every = stop_interval(options, *steps, dt);
  if (!every) return fail(every.error(), exit_usage);

  if (!options.trace.empty()) outputs->trace.emplace(options.trace);
  std::optional<sim::CrossingCheck> check;
  if (options.verify) check.emplace(simulation);
  if (*steps > 0) simulation.measure_step(*steps - 1);
  const auto at_stop = [&](const sim::Diagnostics& state) -> Status {
    if (check) check->add(simulation.read_state(), state.time);
    if (outputs->trace)
      if (Status added = outputs->trace->add(state, simulation.convergence()); !added) return added;
    if (!outputs->states || !options.every) return ok();
    return outputs->states->add(simulation.model(), simulation.scene(), simulation.read_state(),
                                comment(state, scene_name, false));
  };
  const Result<Progress> progress = advance(*prepared, *steps, *every, at_stop);
  if (!progress) return fail(progress.error(), exit_internal);

  const sim::State state = simulation.read_state();
  if (outputs->states && !options.every) {
    const std::string about = comment(progress->state, scene_name, progress->diverged);
    if (Status added = outputs->states->add(simulation.model(), simulation.scene(), state, about); !added)
      return fail(added.error(), exit_internal);
  }
  if (outputs->trace && progress->diverged) outputs->trace->mark_diverged(progress->diverged_by);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Report report = make_report(*prepared, *progress, wall, state);
  if (check) check->report(report);
  if (!options.report.empty())
    if (Status written = write_file(options.report, report.dump(2) + "\n"); !written)
      return fail(written.error(), exit_internal);
  print_summary(report, static_cast<double>(progress->steps) * dt);
  if (check) std::printf("%s\n", check->in_words().c_str());
  print_shortcomings(simulation, progress->state);
  return exit_after(*progress);
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("run", "simulate a scene as fast as it goes; write meshes, a trace, a report");
  const auto options = std::make_shared<RunOptions>();
  options->scene.add_positional(*command);
  command->add_option("--time", options->time, "how long to simulate [s]; rounded to whole steps")
      ->required()
      ->type_name("T");
  command
      ->add_option("--out", options->out,
                   "the final mesh (.obj, .ply, .glb); with --every the series (these, .pc2)")
      ->type_name("F");
  command
      ->add_option("--every", options->every, "time between two samples of --out, --trace and --verify [s]")
      ->type_name("T");
  command
      ->add_option("--trace", options->trace, "a table of energies, strain, speed, contacts over time (.csv)")
      ->type_name("F");
  command->add_option("--report", options->report, "what ran, how fast, and how it ended (.json)")
      ->type_name("F");
  command->add_flag("--verify", options->verify,
                    "count where cloth passes through cloth, in double precision; into the report");
  add_gpu(*command, options->gpu);
  command->footer(R"(Examples:
  clothlab run seed --time 5
  clothlab run seed --time 5 --report report.json --trace trace.csv --every 0.1
  clothlab run seed --time 2 --out cloth.ply --set /cloths/0/material/bend=0
  clothlab run twist --time 10 --report report.json --verify --every 0.05

With --every, samples of cloth.obj go to cloth-0000.obj (the start), cloth-0001.obj, ...; a trace alone has a row
every 0.01 s, and so often states are verified. A crossing is an edge and a triangle without a common vertex that
have a point in common, exactly; touching is one. The report's crossings is the largest number at any sample, and
crossing_check says when and which. The report's step_s is the time of stepping alone: not of setting up,
diagnostics or files.
The result is the same, bit for bit, each time the same build runs the same scene on the same device.)");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace clothlab::cli
