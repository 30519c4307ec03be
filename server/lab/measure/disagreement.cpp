#include "server/lab/measure/disagreement.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/base/text.h"
#include "server/lab/measure/mode_growth.h"
#include "server/model/stability.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

using scene::Method;

/// The factor by which the least limit about the cloth's shapes may exceed the measured boundary and still be
/// its cause: only some of the shapes are looked at, and a shape between them may have a lower limit.
constexpr double limit_tolerance = 1.1;

/// The step limits about the shapes that the cloth takes in a run.
struct Shapes {
  double least = model::no_limit, median = model::no_limit;  ///< [s]
  double longest = 1;                                        ///< largest length of a spring over that at rest
  bool blew_up = false;
};

Result<Shapes> shapes_of(scene::Scene scene, double dt, int steps, ReusedSimulation& full,
                         const std::stop_token& stop) {
  scene.solver.dt = dt;
  const Result<sim::Simulation*> simulation = full.prepare(scene);
  if (!simulation) return simulation.error();
  const model::Model& model = (*simulation)->model();
  Shapes shapes;
  std::vector<double> limits;
  const auto look = [&](sim::Simulation& at) {
    const sim::State state = at.read_state();
    const model::Field shape(state.position.begin(), state.position.end());
    model::each_element(model.elements, [&](const auto& element) {
      shapes.longest = std::max(shapes.longest, 1.0 + element_stretch(element.law, edges(element, 0, shape)));
    });
    limits.push_back(model::dt_limit(scene.solver.method, model::ElementOperator(model, scene, shape), stop));
  };
  const Result<EnergyTrial> trial = run_trial(**simulation, steps, stop, look);
  if (!trial) return trial.error();
  shapes.blew_up = trial->blew_up;
  if (limits.empty()) return shapes;
  std::sort(limits.begin(), limits.end());
  shapes.least = limits.front();
  shapes.median = limits[limits.size() / 2];
  return shapes;
}

bool has_contacts(const scene::Scene& scene) {
  return scene.self_collision || !scene.colliders.empty();
}

/// True if the scene holds at the step `dt` [s] without colliders and self-collision.
Result<bool> holds_bare(const Evidence& evidence, double dt, ReusedSimulation& bare,
                        const std::stop_token& stop) {
  scene::Scene scene = evidence.scene;
  scene.colliders.clear();
  scene.self_collision.reset();
  scene.solver.dt = dt;
  const Result<sim::Simulation*> simulation = bare.prepare(scene);
  if (!simulation) return simulation.error();
  const Result<EnergyTrial> trial = run_trial(**simulation, evidence.steps_of(dt), stop);
  if (!trial) return trial.error();
  return !trial->blew_up;
}

Explanation too_short(const MapColumn& column, const Evidence& evidence, double measured) {
  if (*column.theory == 0.0)
    return {
        Cause::too_short,
        formatted("without damping no step is stable, but slow growth does not show: %d steps of less than "
                  "%.3g s multiply an amplitude by less than e^%.3g",
                  evidence.steps, evidence.shortest_visible_dt, e_folds_to_show)};
  const Method method = evidence.scene.solver.method;
  const double limit = std::max(*column.theory, model::dt_limit(method, evidence.mode));
  return {
      Cause::too_short,
      formatted(
          "5 %% beyond the limit an amplitude grows by e^%.2g a step, and %d steps show it only from about "
          "%.3g s on; measured %.3g s",
          growth_a_step(method, evidence.mode, 1.05 * limit), evidence.steps, evidence.shortest_visible_dt,
          measured)};
}

Result<Explanation> held_too_long(const MapColumn& column, const Evidence& evidence, double measured,
                                  ReusedSimulation& full, const std::stop_token& stop) {
  const double theory = *column.theory;
  if (evidence.shortest_visible_dt > (1.0 + agreement) * theory) return too_short(column, evidence, measured);
  const int longer = 2 * evidence.steps_of(*column.held);
  const Result<Shapes> shapes = shapes_of(evidence.scene, *column.held, longer, full, stop);
  if (!shapes) return shapes.error();
  if (shapes->blew_up)
    return Explanation{Cause::too_short, formatted("in twice as many steps %.3g s fails, too", *column.held)};
  if (shapes->median > (1.0 + agreement) * theory && shapes->median != model::no_limit)
    return Explanation{Cause::shape,
                       formatted("about the shapes that the cloth takes the limit is %.3g s more often "
                                 "than not",
                                 shapes->median)};
  const auto cell = std::find_if(column.cells.begin(), column.cells.end(),
                                 [&](const MapCell& each) { return each.dt == *column.held; });
  return Explanation{
      Cause::bounded,
      formatted("at %.3g s the energy reaches %.3g times that of a stable step, but the run does not blow "
                "up in twice as many steps",
                *column.held, std::pow(10.0, cell->growth))};
}

Result<Explanation> failed_too_soon(const MapColumn& column, const Evidence& evidence, double measured,
                                    ReusedSimulation& full, ReusedSimulation& bare,
                                    const std::stop_token& stop) {
  std::string seen = evidence.failure;
  if (column.held) {
    const Result<Shapes> shapes =
        shapes_of(evidence.scene, *column.held, evidence.steps_of(*column.held), full, stop);
    if (!shapes) return shapes.error();
    const std::string tension =
        formatted("it is stretched to %.3g times its length at rest", shapes->longest) +
        (shapes->least > 0.0
             ? formatted(": about that shape the limit is %.3g s", shapes->least)
             : ", and nothing damps what moves across them: about that shape no step is stable");
    const bool shorter = shapes->least < (1.0 - agreement) * *column.theory;
    if (shorter && shapes->least < limit_tolerance * measured) return Explanation{Cause::tension, tension};
    if (shorter) seen = tension + "; " + seen;
  }
  if (has_contacts(evidence.scene)) {
    const Result<bool> holds = holds_bare(evidence, *column.failed, bare, stop);
    if (!holds) return holds.error();
    if (*holds)
      return Explanation{
          Cause::contacts,
          formatted("contacts: without colliders and self-collision %.3g s holds", *column.failed)};
  }
  return Explanation{Cause::unknown, seen};
}

}  // namespace

const char* phrase(Cause cause) {
  switch (cause) {
    case Cause::none:
      return "";
    case Cause::too_short:
      return "growth beyond the limit is too slow to show in a trial";
    case Cause::tension:
      return "a stretched cloth is stiffer across the stretch, which theory about the rest shape does not "
             "know";
    case Cause::bounded:
      return "beyond the limit the cloth trembles and does not blow up: what grows comes to an end by itself";
    case Cause::shape:
      return "the cloth does not stay near its rest shape";
    case Cause::contacts:
      return "contacts, which theory does not know: without colliders and self-collision the same step holds";
    case Cause::energy:
      return "a method that no step should make unstable gained energy";
    case Cause::unknown:
      return "the cause was not found";
  }
  return "";
}

model::Mode fastest_growing(Method method, const model::ElementOperator& springs,
                            const std::stop_token& stop) {
  const auto of_mode = [&](const model::Mode& mode) { return model::dt_limit(method, mode); };
  const auto stiffest = [](const model::Mode& mode) { return 1.0 / std::sqrt(mode.omega_squared); };
  const model::Field scattered = model::scattered_start(springs);
  if (model::has_single_worst_mode(method))
    return model::extreme_mode(springs, of_mode, scattered, stop).mode;
  const model::ExtremeMode first = model::extreme_mode(springs, stiffest, scattered, stop);
  // Under explicit Euler many vibrations share the limit, and the fastest of them grows the fastest.
  if (method == Method::explicit_euler) return first.mode;
  return model::extreme_mode(springs, of_mode, first.y, stop).mode;
}

std::optional<double> measured_boundary(const MapColumn& column) {
  if (column.held && column.failed) return std::sqrt(*column.held * *column.failed);
  return column.held ? column.held : column.failed;
}

bool disagrees(const MapColumn& column) {
  if (!column.theory) return column.failed.has_value();
  const std::optional<double> measured = measured_boundary(column);
  return measured && !(std::abs(*measured - *column.theory) <= agreement * *column.theory);
}

Result<Explanation> explain(const MapColumn& column, const Evidence& evidence, ReusedSimulation& full,
                            ReusedSimulation& bare, const std::stop_token& stop) {
  if (!column.theory) return Explanation{Cause::energy, evidence.failure};
  const double measured = *measured_boundary(column);
  if (measured > *column.theory) return held_too_long(column, evidence, measured, full, stop);
  return failed_too_soon(column, evidence, measured, full, bare, stop);
}

}  // namespace clothlab::lab
