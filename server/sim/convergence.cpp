#include "server/sim/convergence.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "server/base/text.h"
#include "server/scene/method.h"
#include "server/sim/kernels.h"
#include "server/sim/solved.h"

namespace clothlab::sim {

namespace {

using Clock = std::chrono::steady_clock;

/// The steps from one measurement to the next are worth so many times what it took.
constexpr double steps_for_one = 20.0;
/// Or they are so many times those before: what a cloth does first tells little of what it does later.
constexpr std::uint64_t growth_of_interval = 3;
constexpr std::uint64_t after_a_blow_up = 256;  ///< steps until the next one
/// What a Newton step takes besides its linear iterations, each of which takes as long as a sweep.
constexpr double newton_in_iterations = 8.0;

/// How the solved end of a sweeping method's step is found: where the error is less than twice what this
/// precision may leave, again by the next one. `left`: what the Newton steps may leave of all that there is
/// to solve, measured on falling cotton.
struct Level {
  Integrator::Precision precision;
  double left;
};
constexpr std::array<Level, 2> levels{{{{4, 0.1}, 0.05}, {{12, 0.003}, 0.0}}};

/// That of a method which solves itself: twice its Newton steps, at least three more, each to a tenth of its
/// tolerance. Floats have no more than 1e-6.
Integrator::Precision beyond(const scene::Solver& solver) {
  return {std::max(2 * solver.iterations, solver.iterations + 3), std::max(0.1 * solver.tolerance, 1e-6)};
}

double iterations_in(const SolverWork& work) {
  return static_cast<double>(work.linear_iterations) +
         newton_in_iterations * static_cast<double>(work.newton_steps);
}

std::vector<glm::vec4> downloaded(const gl::Buffer& vectors, std::uint32_t count) {
  std::vector<glm::vec4> words(count);
  vectors.download(words.data(), count * sizeof(glm::vec4));
  return words;
}

void keep(gl::Buffer& copy, const gl::Buffer& of) {
  if (copy.bytes() != of.bytes()) copy = gl::Buffer(of.bytes());
  copy.copy_from(of);
}

/// Sums of squares over the free vertices [m^2].
struct Squares {
  double left = 0;  ///< from the step's end to where it ends if solved
  double all = 0;   ///< from where gravity and inertia take it to there
  double way = 0;   ///< all that a linear solve's tolerance is relative to, as a way in one step
  double free = 0;  ///< vertices

  double mean(double sum) const { return free > 0.0 ? std::sqrt(sum / free) : 0.0; }
};

}  // namespace

bool Convergence::often_unsolved() const {
  return unsolved_steps > 0 && 2 * unsolved_steps >= since_first;
}

std::string in_words(const Convergence& convergence, const scene::Scene& scene) {
  const scene::Solver& solver = scene.solver;
  const bool sweeps = scene::sweeps(solver.method);
  const std::string count = std::to_string(solver.iterations) + (sweeps ? " sweep" : " Newton step") +
                            (solver.iterations == 1 ? "" : "s");
  std::string text = formatted(
      "%llu of %llu steps that were measured ended far from solved: in the last one %s of %s left %.2g of "
      "what there was to solve, worth %.2g mm, where %.2g mm are allowed. Stretch, speed and shape are then "
      "those of the iteration, not of the cloth: ",
      static_cast<unsigned long long>(convergence.unsolved_steps),
      static_cast<unsigned long long>(convergence.measured), count.c_str(), scene::name(solver.method),
      convergence.residual, 1000.0 * convergence.error, 1000.0 * convergence.tolerance);
  // More sweeps of pbd make a spring softer a visit, and bring a cloth no nearer to its N/m.
  if (solver.method == scene::Method::pbd)
    return text + "a smaller dt, or the method xpbd or implicit_euler helps";
  return text + (sweeps ? "more iterations, a smaller dt, or the method implicit_euler helps"
                        : "more iterations, a smaller tolerance or a smaller dt helps");
}

void ConvergenceMeasure::begin(std::uint64_t step) {
  last_ = {};
  begun_ = step;
  next_ = step + first_measured;
}

/// Null: its kernels cannot be made, and nothing is measured.
Integrator* ConvergenceMeasure::solver_for(Kernels& kernels, const scene::Scene& scene) {
  if (scene::solves(scene.solver.method)) return kernels.integrator.get();
  Plan plan = kernels.plan;
  plan.method = scene::Method::implicit_euler;
  // Sweeps know nothing of surfaces, which act after them.
  plan.surfaces = false;
  plan.bodies = 0;
  if (!solver_ || plan != solver_plan_) {
    Result<std::unique_ptr<Integrator>> made = make_implicit_euler(kernels.model, plan);
    if (!made) return nullptr;
    solver_ = std::move(*made);
    solver_plan_ = plan;
  }
  solver_->set_parameters(kernels.surroundings(scene));
  solver_->restart();
  return solver_.get();
}

Work ConvergenceMeasure::measure(const StateBuffers& state, Kernels& kernels, const scene::Scene& scene,
                                 int row, std::uint64_t step) {
  Integrator& integrator = *kernels.integrator;
  next_ = std::numeric_limits<std::uint64_t>::max();
  if (integrator.iterations() == 0 || !solver_for(kernels, scene)) co_return;
  glFinish();
  const Clock::time_point begin = Clock::now();
  // Where contact is a term of the step's problem, a step lists pairs of surfaces anew.
  const auto carry = [&](Carrier carrier) {
    integrator.carry(carrier);
    if (kernels.plan.contact_term()) kernels.surface_contact->carry(carrier);
  };
  carry(Carrier::to(carried_));
  const auto put_back = [&] { carry(Carrier::from(carried_)); };
  keep(places_, state.position().buffer);
  keep(velocities_, state.velocity().buffer);
  trial_.copy_from(state);
  co_await integrator.again(trial_, row);
  keep(end_, trial_.position().buffer);
  put_back();

  const bool own = scene::solves(scene.solver.method);
  const Convergence before = last_;
  double spent = 0.0;
  for (const Level& level : levels) {
    Integrator& solver = *solver_for(kernels, scene);
    SolverWork work;
    trial_.copy_from(state);
    co_await solver.solve(trial_, row, own ? beyond(scene.solver) : level.precision, work);
    put_back();
    spent += iterations_in(work);
    if (take(kernels.model, scene, level.precision.tolerance, level.left) || own) break;
  }
  if (kernels.self_collision) kernels.self_collision->give_up_step();
  if (!std::isfinite(last_.error)) {  // it blows up, which others tell
    last_ = before;
    next_ = step + after_a_blow_up;
  } else {
    count(step, scene, kernels, spent);
  }
  seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Compares the step with its solved end in `trial_`. Returns true if the error is well above what a linear
/// solve to `tolerance` and Newton's method may have left, a share `newton` of all.
bool ConvergenceMeasure::take(const model::Model& model, const scene::Scene& scene, double tolerance,
                              double newton) {
  const std::uint32_t vertices = model.vertex_count();
  const std::vector<glm::vec4> x = downloaded(places_, vertices), v = downloaded(velocities_, vertices),
                               end = downloaded(end_, vertices),
                               solved = downloaded(trial_.position().buffer, vertices);
  const double dt = scene.solver.dt;
  const glm::dvec3 fall = dt * dt * scene.gravity;
  Squares squares;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    if (x[i].w == 0.0f) continue;
    const glm::dvec3 way = dt * glm::dvec3(v[i]), there(solved[i]);
    const glm::dvec3 left = glm::dvec3(end[i]) - there, all = glm::dvec3(x[i]) + way + fall - there;
    squares.left += glm::dot(left, left);
    squares.all += glm::dot(all, all);
    squares.way += glm::dot(way, way) + glm::dot(fall, fall) + glm::dot(all, all);
    squares.free += 1.0;
  }
  last_.error = squares.mean(squares.left);
  // Where a cloth falls freely there is nothing to solve.
  const double task = std::max(squares.all, squares.free * glm::dot(fall, fall));
  last_.residual = task > 0.0 ? std::sqrt(squares.left / task) : 0.0;
  return last_.error > 2.0 * (tolerance * squares.mean(squares.way) + newton * squares.mean(squares.all));
}

void ConvergenceMeasure::count(std::uint64_t step, const scene::Scene& scene, const Kernels& kernels,
                               double spent) {
  ++last_.measured;
  last_.step = step;
  last_.tolerance = allowed_error(kernels.model, scene.solver.method, scene.solver.dt);
  last_.largest_error = std::max(last_.largest_error, last_.error);
  if (last_.unsolved()) ++last_.unsolved_steps;
  if (last_.unsolved_steps > 0) ++last_.since_first;
  // What a step takes: its sweeps, or its Newton steps as they were on average.
  double of_step = scene.solver.iterations;
  if (const SolverWork work = kernels.integrator->work(); work.newton_steps > 0)
    of_step *= iterations_in(work) / static_cast<double>(work.newton_steps);
  const auto worth = static_cast<std::uint64_t>(std::ceil(steps_for_one * (1.0 + spent / of_step)));
  next_ = step + std::min(worth, growth_of_interval * (step + 1 - begun_));
}

}  // namespace clothlab::sim
