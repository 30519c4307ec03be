// How much too far a hanging chain stretches under PBD, XPBD and VBD, against the closed form sum (nodes
// below) m g / k, over dt / u and iterations (u = sqrt(m/k)): the fixed point of the double-precision
// reference, and the prediction by theory. Prints a JSON document.
//
// Prediction. XPBD with one iteration: nearly (dt / u)^2, which tests/unit/hanging_chain.test.cpp derives;
// with many: 0. PBD with one iteration: the same; with many: a / ln(1 + a) - 1, a = 2 (dt / u)^2, except for
// the springs next to the pin, since its visits do not know of one another. VBD: 0, since the sweeps of a
// cloth at rest start where it is. The air takes 2 % of a step, and so of the prediction.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "server/reference/reference.h"
#include "server/scene/method.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr int links = 12, iterations[] = {1, 3, 10, 30, 100};
constexpr double k = 2000.0, mass = 0.005, g = 9.8;  // [N/m], [kg], [m/s^2]
const double unit = std::sqrt(mass / k);             // [s]
const double exact = mass * g * links * (links + 1) / (2 * k);

/// Relative excess of the chain's stretch at rest over the closed form.
double excess(Method method, double share, int count) {
  // The air is so thick that no mode swings, and so thin that it hardly adds to the masses in a step.
  const double air = std::min(3.14159 / links / unit, 0.02 / (share * unit));
  scene::Scene scene = test::chain(method, share * unit, links, k, mass);
  scene.gravity = {0.0, 0.0, g};
  scene.air_drag = air;
  scene.solver.iterations = count;
  const reference::World world = *reference::make_world(scene, 0.0);
  reference::State state = reference::at_rest(world);
  double before = 0.0, now = 0.0;
  const int batch = static_cast<int>(2.0 / (air * scene.solver.dt)) + 1;
  for (int n = 0; n < 100 && (n < 10 || std::abs(now - before) > 1e-7 * exact); ++n) {
    before = now;
    for (int m = 0; m < batch; ++m) reference::step(world, state);
    now = state.position[2 * links].z - 1.0;
  }
  return now / exact - 1.0;
}

}  // namespace

int main() {
  const double shares[] = {0.05, 0.1, 0.2, 0.5, 1.0, 2.0};
  double nodes = links - 1;
  for (int j = 2; j < links; j += 2) nodes += 2 * (links - j);
  const double one = nodes / (links * (links + 1) / 2.0);
  std::printf("{\n \"what\": \"excess of a hanging chain's stretch over the closed form, in percent\",\n");
  std::printf(" \"links\": %d,\n \"iterations\": [1, 3, 10, 30, 100],\n \"rows\": [\n", links);
  bool first = true;
  for (const Method method : {Method::xpbd, Method::pbd, Method::vbd}) {
    for (const double share : shares) {
      const double a = 2 * share * share;
      std::printf(
          "%s  {\"method\": \"%s\", \"dt_over_u\": %.2f, \"predicted_one\": %.2f, \"predicted_many\": %.2f, ",
          first ? "" : ",\n", scene::name(method), share,
          method == Method::vbd ? 0.0 : 100 * one * share * share,
          method == Method::pbd ? 100 * (a / std::log1p(a) - 1.0) : 0.0);
      first = false;
      std::printf("\"excess_percent\": [");
      for (const int count : iterations) {
        std::printf("%s%.2f", count == 1 ? "" : ", ",
                    std::round(1e4 * excess(method, share, count)) / 100 + 0.0);
        std::fflush(stdout);
      }
      std::printf("]}");
    }
  }
  std::printf("\n ]\n}\n");
}
