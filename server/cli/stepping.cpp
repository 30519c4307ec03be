#include "server/cli/stepping.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/automatic.h"
#include "server/lab/measure/choice.h"
#include "server/model/size.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/session/fault.h"
#include "server/sim/motion_table.h"

namespace clothlab::cli {

namespace {

constexpr double most_steps = 1e12;

/// Replaces the method `auto` by the setting that the lab chooses, or by a stable one if the lab cannot
/// choose; `chosen` receives the setting and the reason. A scene with another method is returned unchanged.
Result<scene::Scene> settle_method(scene::Scene scene, std::string& chosen) {
  if (!scene.solver.automatic) return scene;
  note("method auto: measuring what keeps a tolerance of " +
       with_significant_digits(scene.solver.tolerance, 9) + " at the least cost");
  const Result<lab::Choice> choice = lab::choose(scene, {scene.solver.tolerance, {}, {}}, {});
  if (choice) {
    chosen = choice->why;
    scene = lab::with(scene, choice->chosen.setting);
  } else {
    const Result<model::Model> model = model::build(scene);
    if (!model) return model.error();
    const lab::Setting setting = lab::provisional(*model, scene);
    chosen = lab::text(setting) + ", which is stable; nothing better can be chosen: " + choice.error().text();
    scene = lab::with(scene, setting);
  }
  scene.solver.automatic = false;
  note("method auto: " + chosen);
  return scene;
}

}  // namespace

gl::HelperThreads threads_for(const scene::Scene& scene) {
  return gl::needs_no_helper_threads(model::size_of(scene).vertices) ? gl::HelperThreads::none
                                                                     : gl::HelperThreads::sessions;
}

void add_gpu(CLI::App& command, std::optional<int>& gpu) {
  command.add_option("--gpu", gpu, "the device to use, by the number `clothlab info` shows")->type_name("N");
}

std::optional<Prepared> prepare(const SceneChoice& choice, std::optional<int> gpu, int& exit_code) {
  const Result<scene::Document> document = choice.load();
  if (!document) {
    exit_code = fail(document.error(), exit_usage);
    return std::nullopt;
  }
  gl::compute_without_helper_threads();
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create(gpu, threads_for(document->scene));
  if (!context) {
    exit_code = fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
    return std::nullopt;
  }
  std::string chosen;
  const Result<scene::Scene> settled = settle_method(document->scene, chosen);
  if (!settled) {
    exit_code = fail(settled.error(), settled.error().where.starts_with("/") ? exit_usage : exit_internal);
    return std::nullopt;
  }
  Result<std::unique_ptr<sim::Simulation>> simulation = sim::Simulation::create(*settled);
  if (!simulation) {
    // An error at a JSON Pointer ("/...") is a fault of the scene, any other a fault of the program.
    exit_code =
        fail(simulation.error(), simulation.error().where.starts_with("/") ? exit_usage : exit_internal);
    return std::nullopt;
  }
  const double limit = model::dt_limit_if_near((*simulation)->model(), *settled);
  print_warnings((*simulation)->model(), *settled, limit);
  return Prepared{std::move(*context), std::move(*simulation), limit, chosen};
}

Result<std::uint64_t> whole_steps(const std::string& option, double seconds, double dt) {
  if (!std::isfinite(seconds) || seconds < 0)
    return Error{option, with_significant_digits(seconds, 9), "a time in seconds, 0 or more"};
  const double steps = std::round(seconds / dt);
  if (steps > most_steps)
    return Error{option, with_significant_digits(seconds, 9),
                 "at most " + with_significant_digits(most_steps * dt, 9) + " s at this dt"};
  if (std::abs(steps * dt - seconds) > 1e-6 * dt)
    note(option + " " + with_significant_digits(seconds, 9) + " is not a whole number of steps of " +
         with_significant_digits(dt, 9) + " s; taken as " + with_significant_digits(steps * dt, 9));
  return static_cast<std::uint64_t>(steps);
}

Result<Progress> advance(const Prepared& prepared, std::uint64_t steps, std::uint64_t every,
                         const AtStop& at_stop) {
  sim::Simulation& simulation = *prepared.simulation;
  Progress progress;
  // One step that is not timed: drivers compile a kernel when it first runs.
  sim::timed_steps(simulation, 1);
  simulation.reset();
  const std::uint64_t judged_every = sim::judged_every(simulation.scene(), simulation.model());
  sim::GuardedRun run(simulation);
  run.start(prepared.dt_limit);
  progress.state = run.state();
  if (Status stop = at_stop(progress.state); !stop) return stop.error();

  std::uint64_t next_stop = 0;
  while (progress.steps < steps) {
    if (progress.steps == next_stop) next_stop = std::min(next_stop + every, steps);
    const std::uint64_t count =
        std::min(next_stop - progress.steps, judged_every - progress.steps % judged_every);
    progress.step_seconds += run.step(static_cast<std::uint32_t>(count));
    progress.steps += count;
    if (progress.steps % judged_every == 0 || progress.steps == steps)
      progress.diverged = run.judge_now() == sim::GuardedRun::Verdict::blown_up;
    else
      run.look();  // whoever has the run stop here changes nothing of what is said of it
    if (prepared.context->lost() ||
        session::fault_due(session::Fault::context_lost, session::fault_in_run, progress.steps))
      return Error{"OpenGL",
                   "the device was reset at step " + std::to_string(progress.steps) +
                       ", and all that was on it is lost",
                   "start again; if it happens again, see the driver's log"};
    if (progress.diverged) {
      progress.diverged_by = simulation.time();
      progress.setback = run.go_back();
    }
    progress.state = run.state();
    if (progress.diverged) return progress;
    if (progress.steps == next_stop)
      if (Status stop = at_stop(progress.state); !stop) return stop.error();
  }
  return progress;
}

int exit_after(const Progress& progress) {
  if (!progress.diverged) return exit_done;
  const model::Remedy& remedy = progress.setback.remedy;
  note("the simulation diverged: " + progress.setback.reason + "; what was good, up to t = " +
       with_significant_digits(progress.state.time, 9) + " s, is kept. " + remedy.text + ": " +
       (remedy.method ? std::string("--set /solver/method=") + scene::name(*remedy.method) + " " : "") +
       "--set /solver/dt=" + with_significant_digits(remedy.dt, 9));
  return exit_diverged;
}

}  // namespace clothlab::cli
