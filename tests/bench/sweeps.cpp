// A step of PBD, XPBD and VBD in the kernel's two forms, one work group and one dispatch per colour, on the
// seed scene with SIDE vertices per side. Usage: bench_sweeps SIDE...; it prints a JSON document:
// microseconds per step, the median of rounds in which all take turns.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "server/gl/context.h"
#include "server/scene/method.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr int rounds = 15, steps = 20;
constexpr const char* forms[] = {"one_group", "dispatches"};

struct Contestant {
  Method method;
  int iterations, form;
  std::unique_ptr<sim::Simulation> simulation;
  std::vector<double> us;

  void run() {
    const double start = bench::seconds();
    simulation->step(steps);
    simulation->finish();
    us.push_back((bench::seconds() - start) * 1e6 / steps);
  }
  double median() {
    std::sort(us.begin(), us.end());
    return us[us.size() / 2];
  }
};

Contestant contestant(int side, Method method, int iterations, int form) {
  setenv("CLOTHLAB_SWEEPS", forms[form], 1);
  scene::Scene scene = bench::seed_of(side);
  scene.solver = {method, 1e-3, iterations, 1e-4};
  auto simulation = sim::Simulation::create(scene);
  if (!simulation) std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), std::exit(1);
  Contestant made{method, iterations, form, std::move(*simulation), {}};
  made.run();  // compiles
  made.us.clear();
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fputs("usage: bench_sweeps SIDE...\n", stderr), 2;
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  std::printf("{\n \"what\": \"a step on the seed scene without self-collision [us], median\",\n");
  std::printf(" \"renderer\": \"%s\",\n \"rows\": [", (*context)->device().name.c_str());
  for (int arg = 1; arg < argc; ++arg) {
    const int side = std::atoi(argv[arg]);
    std::vector<Contestant> all;
    for (const Method method : {Method::pbd, Method::xpbd, Method::vbd})
      for (const int iterations : {1, 10})
        for (const int form : {0, 1}) all.push_back(contestant(side, method, iterations, form));
    for (int round = 0; round < rounds; ++round)
      for (Contestant& one : all) one.run();
    for (std::size_t i = 0; i < all.size(); i += 2)
      std::printf(
          "%s\n  {\"side\": %d, \"method\": \"%s\", \"iterations\": %d, \"one_group\": %.0f, \"dispatches\": "
          "%.0f}",
          arg == 1 && i == 0 ? "" : ",", side, scene::name(all[i].method), all[i].iterations, all[i].median(),
          all[i + 1].median());
  }
  std::printf("\n ]\n}\n");
}
