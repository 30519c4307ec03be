#include "server/model/remedy.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"

namespace clothlab::model {

namespace {

constexpr double safe_share = 0.8;
constexpr double least_step_share = 0.1;  // a step below this share of the present one makes a run too slow
constexpr std::size_t most_searched = 20000;  // vertices whose limit is searched in well under a second
constexpr double frame_time = 0.016;          // [s], a display frame at about 60 Hz

double within_safe_share(double limit) {
  return std::max(rounded_down(safe_share * limit), scene::ranges::dt.minimum);
}

/// The longest stable step [s], if the scene's is near it or beyond.
double limit_near(const Model& model, const scene::Scene& scene) {
  return model.vertex_count() <= most_searched ? dt_limit_if_near(model, scene)
                                               : dt_limit_bound(model, scene);
}

}  // namespace

double rounded_down(double value) {
  const int digits = 1 - static_cast<int>(std::floor(std::log10(value)));
  // Negative powers of ten are rounded: divide by the exact positive power instead of multiplying by them.
  const double scale = std::pow(10.0, std::abs(digits));
  const double shifted = digits >= 0 ? value * scale : value / scale;
  const double whole = std::floor(shifted + 1e-9);
  return digits >= 0 ? whole / scale : whole * scale;
}

Remedy remedy(const Model& model, const scene::Scene& scene, double limit) {
  const scene::Solver& solver = scene.solver;
  Remedy remedy;
  remedy.dt = solver.dt;
  if (solver.method == scene::Method::explicit_euler) {
    scene::Scene other = scene;
    other.solver.method = scene::Method::symplectic_euler;
    const double holds = dt_limit_bound(model, other);
    if (solver.dt > safe_share * holds) remedy.dt = within_safe_share(holds);
    remedy.method = other.solver.method;
    remedy.text =
        std::string("use symplectic_euler, which costs the same") +
        (remedy.dt < solver.dt ? ", with dt = " + with_significant_digits(remedy.dt, 4) + " s" : "");
  } else if (safe_share * limit < std::max(least_step_share * solver.dt, scene::ranges::dt.minimum)) {
    remedy.dt = std::min(solver.dt, frame_time);
    remedy.method = scene::Method::implicit_euler;
    remedy.text =
        "use implicit_euler, which has no such limit, with dt = " + with_significant_digits(remedy.dt, 4) +
        " s; " + scene::name(solver.method) + " would need a step below " +
        with_significant_digits(limit, 4) + " s";
  } else if (solver.dt > margin_to_warn * limit) {
    remedy.dt = within_safe_share(limit);
    remedy.text = "set dt to " + with_significant_digits(remedy.dt, 4) + " s, 80 % of the limit";
  } else if (solver.method != scene::Method::implicit_euler) {
    // The limit about the rest shape is not the cause: the cloth is stiffer in its present shape, or some
    // other part adds energy. A shorter step might have to be shortened again and again.
    remedy.dt = std::min(solver.dt, frame_time);
    remedy.method = scene::Method::implicit_euler;
    remedy.text = "use implicit_euler, which holds whatever stiffens the cloth, with dt = " +
                  with_significant_digits(remedy.dt, 4) + " s; the dt used with " +
                  scene::name(solver.method) + " was within the limit for the cloth at rest";
  } else {
    remedy.dt = std::max(rounded_down(0.5 * solver.dt), scene::ranges::dt.minimum);
    remedy.text = "halve the time step, to dt = " + with_significant_digits(remedy.dt, 4) + " s";
  }
  return remedy;
}

scene::Solver step_that_holds(const Model& model, const scene::Scene& scene) {
  scene::Solver solver = scene.solver;
  if (solver.automatic) return solver;  // the lab chooses a step that holds
  const double limit = limit_near(model, scene);
  if (limit > 0.0 && solver.dt > margin_to_warn * limit) solver.dt = within_safe_share(limit);
  return solver;
}

scene::Solver solver_that_holds(const Model& model, const scene::Scene& scene) {
  scene::Solver solver = scene.solver;
  if (solver.automatic) return solver;  // likewise
  const double limit = limit_near(model, scene);
  if (solver.dt <= margin_to_warn * limit) return solver;
  if (safe_share * limit >= 0.5 * solver.dt) {
    solver.dt = within_safe_share(limit);
    return solver;
  }
  solver.method = scene::Method::implicit_euler;
  solver.dt = 1.0 / 60.0;
  solver.iterations = 10;  // at most: they end where a step is solved
  solver.tolerance = 0.05;
  return solver;
}

std::string against_limit(const scene::Solver& solver, double limit) {
  const std::string step = ": dt = " + with_significant_digits(solver.dt, 4) + " s",
                    method = scene::name(solver.method);
  const std::optional<double> share = margin(solver.dt, limit);
  if (limit <= 0.0) return ": " + method + " without damping is stable at no step";
  if (!share) return step + ", for which " + method + " has no limit of stability";
  if (*share <= 1.0)
    return step + " is only " + with_significant_digits(*share, 4) + " of the longest stable step of " +
           method + " about the rest shape, " + with_significant_digits(limit, 4) +
           " s; here the cloth is stiffer than that";
  return step + " is " + with_significant_digits(*share, 4) + " times the longest stable step of " + method +
         ", " + with_significant_digits(limit, 4) + " s";
}

}  // namespace clothlab::model
