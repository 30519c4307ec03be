// Cost of a step of a sheet of finite elements, with and without bending, against one of springs of all kinds
// on the same grid, under each explicit method. They take turns in every round, so that a noisy machine
// disturbs all alike and their ratios stay valid. Usage: bench_models SIDE ROUNDS; it prints one JSON line
// per method and model. models.mjs runs it for all sizes.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "server/gl/context.h"
#include "server/model/stability.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"

using namespace clothlab;
using scene::Method;

namespace {

struct Contestant {
  Method method;
  const char* model;
  std::unique_ptr<sim::Simulation> simulation;
  std::vector<double> samples;  ///< [ns] per vertex and step
};

/// The swinging seed without its sphere: cotton, or springs. Half of the step that surely holds.
scene::Scene sheet(int side, Method method, const scene::Material& material) {
  scene::Scene scene = bench::seed_of(side);
  scene.colliders.clear();
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.1036};
  scene.cloths[0].material = material;
  scene.solver = {.method = method, .dt = 1e-6};
  const auto model = model::build(scene);
  if (model) scene.solver.dt = std::max(1e-7, 0.5 * model::dt_limit_bound(*model, scene));
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: bench_models SIDE ROUNDS\n", stderr), 2;
  const int side = std::atoi(argv[1]), rounds = std::atoi(argv[2]);
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;

  const double vertices = static_cast<double>(side) * side;
  const auto steps = static_cast<std::uint32_t>(20 + 4e5 / vertices);  // about a tenth of a second
  scene::Fem cotton, limp;
  limp.bending = {0.0, 0.0, std::nullopt};
  const scene::Springs springs{3000.0, 97.0, 10.0, 0.01};
  std::vector<Contestant> contestants;
  for (const Method method : {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4})
    for (const auto& [name, material] : {std::pair<const char*, scene::Material>("springs", springs),
                                         {"fem", cotton},
                                         {"fem without bending", limp}}) {
      auto simulation = sim::Simulation::create(sheet(side, method, material));
      if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), 1;
      contestants.push_back({method, name, std::move(*simulation), {}});
      contestants.back().simulation->step(50);  // compiles
      contestants.back().simulation->finish();
    }
  for (int round = 0; round < rounds; ++round)
    for (Contestant& one : contestants) {
      const double start = bench::seconds();
      one.simulation->step(one.method == Method::rk4 ? steps / 4 : steps);
      one.simulation->finish();
      const double taken = bench::seconds() - start;
      one.samples.push_back(taken * 1e9 / (one.method == Method::rk4 ? steps / 4 : steps) / vertices);
    }
  for (const Contestant& one : contestants) {
    std::printf("{\"renderer\": \"%s\", \"side\": %d, \"method\": \"%s\", \"model\": \"%s\", \"ns\": [",
                (*context)->device().name.c_str(), side, scene::name(one.method), one.model);
    for (std::size_t i = 0; i < one.samples.size(); ++i) std::printf("%s%.2f", i ? ", " : "", one.samples[i]);
    std::puts("]}");
  }
}
