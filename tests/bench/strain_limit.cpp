// Cost and effect of the strain limit: the seed's heavy cloth (0.1 kg per vertex) hangs from two corners for
// 1 s under symplectic Euler at 1 ms. Prints one JSON line per limit; methods.mjs runs it.
#include <algorithm>
#include <cstdio>

#include "server/gl/context.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"
#include "tests/stretch.h"

using namespace clothlab;

namespace {

scene::Scene heavy(double limit) {
  scene::Scene scene;
  scene::Cloth cloth;
  cloth.transform.translate = {0.0, 1.0, 0.0};
  cloth.mesh = scene::Grid{25, 25, 1.0, 1.0};
  cloth.pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{24, 0}, {}}};
  if (limit > 0) cloth.springs().strain_limit = limit;
  scene.cloths = {cloth};
  return scene;
}

}  // namespace

int main() {
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  for (const double limit : {0.0, 0.3, 0.2, 0.1, 0.05, 0.02}) {
    const auto simulation = sim::Simulation::create(heavy(limit));
    if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), 1;
    (*simulation)->step(10);
    (*simulation)->finish();
    (*simulation)->reset();
    const sim::StrainLimitWork before = (*simulation)->strain_limit_work();
    double stretch = 0.0, spent = 0.0;
    for (int look = 0; look < 20; ++look) {
      const double start = bench::seconds();
      (*simulation)->step(50);
      (*simulation)->finish();
      spent += bench::seconds() - start;
      stretch = std::max(stretch, test::largest_stretch(**simulation));
    }
    const sim::StrainLimitWork work = (*simulation)->strain_limit_work();
    std::printf(
        "{\"limit\": %g, \"largest_stretch\": %.4f, \"sweeps_a_step\": %.2f, \"unconverged_steps\": %llu, "
        "\"us_a_step\": %.1f}\n",
        limit, stretch, static_cast<double>(work.sweeps - before.sweeps) / 1000,
        static_cast<unsigned long long>(work.unconverged - before.unconverged), 1e6 * spent / 1000);
  }
}
