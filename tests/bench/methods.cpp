// Cost of a step under each method, on the seed scene with SIDE vertices per side: time, dispatches, bytes.
// The methods take turns in every round, so that a noisy machine disturbs all alike and their ratios stay
// valid. Usage: bench_methods SIDE ROUNDS [METHOD]; it prints one JSON line per method. methods.mjs runs it
// for all sizes.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "server/gl/context.h"
#include "server/scene/method.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"

using namespace clothlab;

namespace {

/// dt below each method's limit; implicit Euler at its usual 1/60 s with one Newton step; methods that sweep
/// at 1 ms with one and with ten sweeps.
std::vector<scene::Solver> settings() {
  std::vector<scene::Solver> result;
  for (const scene::Method method : scene::methods) {
    const double dt = method == scene::Method::explicit_euler ? 5e-5
                      : scene::solves(method)                 ? 1.0 / 60
                                                              : 1e-3;
    result.push_back({method, dt, 1, 1e-4});
    if (scene::sweeps(method)) result.push_back({method, dt, 10, 1e-4});
  }
  return result;
}

/// Without self-collision, which costs the same under most methods.
scene::Scene seed_of(int side, const scene::Solver& solver) {
  scene::Scene scene = bench::seed_of(side);
  scene.solver = solver;
  return scene;
}

/// Number of steps for a round of about a tenth of a second.
std::uint32_t steps_a_round(const scene::Solver& solver, double vertices) {
  if (scene::solves(solver.method)) return 3;
  const double steps = 20 + 2e5 / vertices;
  return static_cast<std::uint32_t>(scene::sweeps(solver.method) ? 2 + steps / (10 * solver.iterations)
                                                                 : steps);
}

/// Bytes that the kernels of one step read and write per vertex with `entries` springs, without caches: 16
/// for each spring entry, position, velocity or other vector, as the shaders list them. `iterations`: of
/// conjugate gradients, or sweeps. Deviations count as memory, though a small cloth keeps them in its work
/// group.
double bytes_a_vertex(scene::Method method, double entries, double iterations) {
  const double vector = 16;
  const double gather = entries * 3 * vector + 2 * vector;  // for each spring: entry, position, velocity
  switch (method) {
    case scene::Method::explicit_euler:
    case scene::Method::symplectic_euler:
      return gather + 2 * vector;
    case scene::Method::verlet:
      return gather + 4 * vector;
    case scene::Method::rk4:
      return 4 * gather + (3 + 5 + 5 + 7) * vector;
    case scene::Method::pbd:
    case scene::Method::xpbd: {  // begin and finish; springs and the pass of contacts for each sweep
      const double springs = entries / 2, remembered = method == scene::Method::xpbd ? iterations - 1 : 0;
      return (5 + 9) * vector + iterations * (springs * (9 * vector + 8) + 4 * vector) +
             remembered * springs * 2 * vector;
    }
    case scene::Method::vbd:
      return (8 + 9) * vector + iterations * (entries * 4 * vector + 5 * vector + 4);
    case scene::Method::implicit_euler:
    case scene::Method::bdf2:
      break;
  }
  const double once = (3 + 6) * vector + (entries * 4 + 5 + 4) * vector +  // start, system
                      (entries * 4 + 4) * vector + (7 + 4) * vector +      // search, advance
                      (9 + 2) * vector;                                    // end
  const double guess = (entries * 5 + 5 + 3) * vector + (9 + 2) * vector;  // project, improve
  // multiply, update; every eighth time collect and precondition
  return once + guess + iterations * ((entries * 3 + 4 + 1) + (11 + 5) + (3 + 6 + 1) / 8.0) * vector;
}

struct Contestant {
  scene::Solver solver;
  std::uint32_t steps;  ///< per round
  std::unique_ptr<sim::Simulation> simulation;
  std::vector<double> samples;  ///< [ns] per vertex and step
  std::uint64_t steps_before = 0, dispatches_before = 0;
  sim::SolverWork work_before;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) return std::fputs("usage: bench_methods SIDE ROUNDS [METHOD]\n", stderr), 2;
  const int side = std::atoi(argv[1]), rounds = std::atoi(argv[2]);
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;

  const double vertices = static_cast<double>(side) * side;
  std::vector<Contestant> contestants;
  for (const scene::Solver& solver : settings()) {
    if (argc == 4 && std::string_view(argv[3]) != scene::name(solver.method)) continue;
    auto simulation = sim::Simulation::create(seed_of(side, solver));
    if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), 1;
    contestants.push_back({solver, steps_a_round(solver, vertices), std::move(*simulation), {}, 0, 0, {}});
    // Compiles, and sets the cloth in motion.
    contestants.back().simulation->step(steps_a_round(solver, vertices) < 20 ? 10 : 100);
    contestants.back().simulation->finish();
    contestants.back().steps_before = contestants.back().simulation->step_index();
    contestants.back().dispatches_before = contestants.back().simulation->dispatches();
    contestants.back().work_before = contestants.back().simulation->solver_work();
  }
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& one : contestants) {
      const double start = bench::seconds();
      one.simulation->step(one.steps);
      one.simulation->finish();
      one.samples.push_back((bench::seconds() - start) * 1e9 / one.steps / vertices);
    }
  }
  for (Contestant& one : contestants) {
    const auto steps = static_cast<double>(one.simulation->step_index() - one.steps_before);
    const sim::SolverWork work = one.simulation->solver_work();
    const double cg_iterations =
        static_cast<double>(work.linear_iterations - one.work_before.linear_iterations) / steps;
    const double sweeps = scene::sweeps(one.solver.method) ? one.solver.iterations : cg_iterations;
    const double entries = 2.0 * static_cast<double>(one.simulation->model().springs().size()) / vertices;
    std::printf(
        "{\"renderer\": \"%s\", \"side\": %d, \"method\": \"%s\", \"dt\": %g, \"iterations\": %d, "
        "\"dispatches\": %.1f, "
        "\"bytes_a_vertex\": %.0f, \"cg_iterations\": %.1f, \"ns\": [",
        (*context)->device().name.c_str(), side, scene::name(one.solver.method), one.solver.dt,
        one.solver.iterations,
        static_cast<double>(one.simulation->dispatches() - one.dispatches_before) / steps,
        bytes_a_vertex(one.solver.method, entries, sweeps), cg_iterations);
    for (std::size_t i = 0; i < one.samples.size(); ++i) std::printf("%s%.2f", i ? ", " : "", one.samples[i]);
    std::puts("]}");
  }
}
