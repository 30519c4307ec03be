// Error against dt, for the table of tests/README.md: the swinging 17 x 17 cloth at 0.3 s under symplectic
// Euler, Verlet, RK4, PBD, XPBD and VBD, by the reference in double precision and by the GPU in float32,
// against RK4 in double precision at u/200 (u = sqrt(m/k)). XPBD is also run as most write it in float32,
// with velocities from differences of positions: it shows what the GPU's deviations gain. Prints a JSON
// document.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "server/gl/context.h"
#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "server/sim/simulation.h"
#include "tests/bench/float32_xpbd.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using scene::Method;
using Positions = std::vector<glm::dvec3>;

namespace {

constexpr double end = 0.3;                                            // [s], before the cloth buckles
constexpr double shares[] = {0.6, 0.3, 0.15, 0.075, 0.0375, 0.01875};  // of u

Positions in_double(const scene::Scene& scene, int steps) {
  const reference::World world = *reference::make_world(scene, 0.0);
  reference::State state = reference::at_rest(world);
  for (int n = 0; n < steps; ++n) reference::step(world, state);
  return state.position;
}

Positions on_gpu(const scene::Scene& scene, int steps) {
  const auto simulation = sim::Simulation::create(scene);
  if (!simulation)
    return std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), std::exit(1), Positions{};
  (*simulation)->step(static_cast<std::uint32_t>(steps));
  const sim::State state = (*simulation)->read_state();
  return {state.position.begin(), state.position.end()};
}

int steps_of(double share) {
  return static_cast<int>(std::lround(end / (share * test::cloth_unit)));
}

struct Contestant {
  Method method;
  int iterations;  ///< 0 if the method does not iterate
};

void print_row(const Contestant& row, const char* precision, const std::vector<double>& errors) {
  static bool first = true;
  std::printf("%s  {\"method\": \"%s\", ", first ? "" : ",\n", scene::name(row.method));
  first = false;
  if (row.iterations) std::printf("\"iterations\": %d, ", row.iterations);
  std::printf("\"precision\": \"%s\", \"rms_error_m\": [", precision);
  for (std::size_t i = 0; i < errors.size(); ++i) std::printf("%s%.2e", i ? ", " : "", errors[i]);
  std::printf("]}");
  std::fflush(stdout);
}

}  // namespace

int main() {
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  const reference::World world = *reference::make_world(test::swinging_cloth(Method::rk4, 1.0), 0.0);
  const auto truth = reference::trajectory(world, {end}, test::cloth_unit / 100);
  if (!truth) return std::fprintf(stderr, "%s\n", truth.error().text().c_str()), 1;
  const Positions& exact = truth->states[0].position;

  std::printf(
      "{\n \"what\": \"RMS position error [m] at 0.3 s of the swinging 17 x 17 cloth, against dt\",\n");
  std::printf(" \"renderer\": \"%s\",\n \"u_s\": %.6e,\n", (*context)->device().name.c_str(),
              test::cloth_unit);
  std::printf(
      " \"reference\": {\"method\": \"rk4, float64\", \"dt_over_u\": %.4f, \"difference_to_twice_dt_m\": "
      "%.1e},\n",
      truth->dt / test::cloth_unit, truth->error[0]);
  std::printf(" \"dt_over_u\": [");
  for (const double share : shares)
    std::printf("%s%.4f", share == shares[0] ? "" : ", ", end / steps_of(share) / test::cloth_unit);
  std::printf("],\n \"rows\": [\n");
  for (const Contestant& row :
       {Contestant{Method::symplectic_euler, 0}, Contestant{Method::verlet, 0}, Contestant{Method::rk4, 0},
        Contestant{Method::xpbd, 1}, Contestant{Method::xpbd, 10}, Contestant{Method::pbd, 10},
        Contestant{Method::vbd, 10}}) {
    std::vector<double> float64, float32, rounding, differences;
    for (const double share : shares) {
      const int steps = steps_of(share);
      scene::Scene scene = test::swinging_cloth(row.method, end / steps);
      if (row.iterations) scene.solver.iterations = row.iterations;
      const Positions ours = in_double(scene, steps), theirs = on_gpu(scene, steps);
      float64.push_back(reference::rms_distance(ours, exact));
      float32.push_back(reference::rms_distance(theirs, exact));
      rounding.push_back(reference::rms_distance(theirs, ours));
      if (row.method == Method::xpbd && row.iterations == 1)
        differences.push_back(reference::rms_distance(
            bench::xpbd_by_differences(*reference::make_world(scene, 0.0), steps), exact));
    }
    print_row(row, "float64, reference", float64);
    print_row(row, "float32, GPU", float32);
    print_row(row, "float32 - float64", rounding);
    if (!differences.empty()) print_row(row, "float32, differences of positions", differences);
  }
  std::printf("\n");
  std::printf(" ]\n}\n");
}
