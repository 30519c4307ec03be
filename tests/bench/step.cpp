// Stepping cost of one configuration: the seed scene on a grid of any size. Prints one JSON line; step.mjs
// runs it for all configurations. CLOTHLAB_READS=storage measures reads through storage buffers instead of
// buffer textures.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/gl/context.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"

using namespace clothlab;

namespace {

/// The contact distance keeps its share of the spacing, 0.24, so that every size does the same work per
/// vertex.
scene::Scene seed_of(int side, bool self_collision) {
  scene::Scene scene = bench::seed_of(side);
  if (self_collision) scene.self_collision = scene::SelfCollision{0.24 / (side - 1), 0.2};
  return scene;
}

}  // namespace

/// bench_step SIDE SELF_COLLISION(0|1) WARM_UP_STEPS STEPS REPEATS
int main(int argc, char** argv) {
  if (argc != 6)
    return std::fputs("usage: bench_step SIDE SELF_COLLISION WARM_UP STEPS REPEATS\n", stderr), 2;
  const int side = std::atoi(argv[1]), self_collision = std::atoi(argv[2]), repeats = std::atoi(argv[5]);
  const auto warm_up = static_cast<std::uint32_t>(std::atoi(argv[3]));
  const auto steps = static_cast<std::uint32_t>(std::atoi(argv[4]));
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  const auto simulation = sim::Simulation::create(seed_of(side, self_collision != 0));
  if (!simulation) return std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), 1;

  (*simulation)->step(warm_up);
  (*simulation)->finish();
  std::printf("{\"renderer\": \"%s\", \"side\": %d, \"self_collision\": %s, \"ns_per_vertex_step\": [",
              (*context)->device().name.c_str(), side, self_collision ? "true" : "false");
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start = bench::seconds();
    (*simulation)->step(steps);
    (*simulation)->finish();
    std::printf("%s%.2f", repeat ? ", " : "", (bench::seconds() - start) * 1e9 / steps / (side * side));
  }
  std::printf("]}\n");
}
