// Cost of the same accuracy under each method: for the swinging cloth of tests/README.md (17 x 17, 0.3 s) it
// finds the cheapest dt and iterations whose RMS position error is 1e-2, 1e-3 and 1e-4 of the cloth's size,
// and the milliseconds of stepping per simulated second. Errors are the same in every run, so they are
// searched first; the settings near the cheapest are then timed in turns. Prints a JSON document.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "server/gl/context.h"
#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "server/sim/simulation.h"
#include "tests/bench/seed.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr double end = 0.3;                       // [s], before the cloth buckles
constexpr double size = 0.5;                      // [m]
constexpr double targets[] = {1e-2, 1e-3, 1e-4};  // of the size
constexpr double most_work = 1 << 17;             // for one error, in forces of all springs
constexpr double hopeless = 1.6;                  // times the work with other iterations
constexpr int rounds = 5;
constexpr double enough_time = 8.0;  // [s] for three or more samples of one setting

struct Setting {
  Method method;
  int iterations, steps;
};

/// Estimated cost, in forces, to choose the settings to try and to time: a sweep costs about as much as a
/// force; a small step of implicit Euler, which needs few iterations of conjugate gradients, about 12.
double work(const Setting& setting) {
  const double step = scene::solves(setting.method)   ? 12.0
                      : setting.method == Method::rk4 ? 4.0
                      : scene::sweeps(setting.method) ? 0.6 + setting.iterations
                                                      : 1.0;
  return step * setting.steps;
}

/// The steps tried with one number of iterations.
struct Ladder {
  int iterations;
  std::vector<std::pair<int, double>> rungs = {};  // steps, error [m]: infinite if it blew up
  bool too_slow = false;
};

/// A setting that reaches a target, and its measurements.
struct Candidate {
  Setting setting;
  double error;
  double seconds = 0;                // spent on the samples
  std::vector<double> samples = {};  // [ms] per simulated second
};

scene::Scene scene_of(const Setting& setting) {
  scene::Scene scene = test::swinging_cloth(setting.method, end / setting.steps);
  scene.solver.iterations = setting.iterations;
  // with 1e-4 small steps would need no iteration at all, and their errors add up
  scene.solver.tolerance = 1e-6;
  return scene;
}

std::unique_ptr<sim::Simulation> simulation_of(const Setting& setting) {
  auto simulation = sim::Simulation::create(scene_of(setting));
  if (!simulation) std::fprintf(stderr, "%s\n", simulation.error().text().c_str()), std::exit(1);
  (*simulation)->step(3);  // compiles
  (*simulation)->finish();
  (*simulation)->reset();
  return std::move(*simulation);
}

class Search {
 public:
  explicit Search(std::vector<glm::dvec3> exact) : exact_(std::move(exact)) {}

  double error(const Setting& setting) {
    const auto simulation = simulation_of(setting);
    simulation->step(static_cast<std::uint32_t>(setting.steps));
    const sim::State state = simulation->read_state();
    const double error = reference::rms_distance({state.position.begin(), state.position.end()}, exact_);
    return std::isfinite(error) ? error : HUGE_VAL;
  }

  /// Tries steps, each shorter by sqrt(2), until the last target is met, the error no longer falls, or other
  /// iterations reach the next target with far less work. `least_work`: for each target; lowered here.
  Ladder climb(Method method, int iterations, std::array<double, 3>& least_work) {
    Ladder ladder{iterations};
    double least = HUGE_VAL;
    int risen = 0, target = 0;
    for (double steps = 8.0; risen < 6; steps *= std::sqrt(2.0)) {
      const Setting setting{method, iterations, static_cast<int>(std::lround(steps))};
      ladder.too_slow = work(setting) > std::min(most_work, hopeless * least_work[target]);
      if (ladder.too_slow) break;
      const double found = error(setting);
      ladder.rungs.emplace_back(setting.steps, found);
      while (target < 3 && found <= targets[target] * size) {
        least_work[target] = std::min(least_work[target], work(setting));
        ++target;
      }
      if (target == 3) break;
      risen = found < 0.98 * least || found > 0.1 * size ? 0 : risen + 1;
      least = std::min(least, found);
    }
    return ladder;
  }

  /// The fewest steps, to about 9 %, that reach `target`: between the rung that does and the one before.
  std::optional<Candidate> first(Method method, const Ladder& ladder, double target, double most) {
    const auto reaches = [&](const auto& rung) { return rung.second <= target * size; };
    const auto found = std::find_if(ladder.rungs.begin(), ladder.rungs.end(), reaches);
    if (found == ladder.rungs.end() || work({method, ladder.iterations, found->first}) > most)
      return std::nullopt;
    Candidate best{{method, ladder.iterations, found->first}, found->second};
    if (found == ladder.rungs.begin()) return best;
    int too_few = std::prev(found)->first;
    for (int halving = 0; halving < 2; ++halving) {
      const int between = static_cast<int>(std::lround(std::sqrt(double(too_few) * best.setting.steps)));
      if (between == too_few || between == best.setting.steps) break;
      const double found_between = error({method, ladder.iterations, between});
      if (found_between <= target * size)
        best = {{method, ladder.iterations, between}, found_between};
      else
        too_few = between;
    }
    return best;
  }

 private:
  std::vector<glm::dvec3> exact_;
};

std::vector<int> iterations_of(Method method) {
  if (scene::sweeps(method)) return {1, 2, 4, 8, 16};
  if (scene::solves(method)) return {1, 4};
  return {1};
}

void time_once(Candidate& candidate) {
  if (candidate.samples.size() >= 3 && candidate.seconds > enough_time) return;
  const auto simulation = simulation_of(candidate.setting);
  const double start = bench::seconds();
  simulation->step(static_cast<std::uint32_t>(candidate.setting.steps));
  simulation->finish();
  const double spent = bench::seconds() - start;
  candidate.seconds += spent;
  candidate.samples.push_back(1000.0 * spent / end);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Outcome {
  Method method;
  std::vector<Ladder> ladders;
  std::vector<Candidate> candidates[3];  // for each target
};

Outcome search_all(Search& search, Method method) {
  Outcome outcome{method, {}, {}};
  std::array<double, 3> least_work{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (const int iterations : iterations_of(method)) {
    const Ladder ladder = search.climb(method, iterations, least_work);
    outcome.ladders.push_back(ladder);
    std::fprintf(stderr, "%s, %d iterations: %d steps, %.1e m\n", scene::name(method), iterations,
                 ladder.rungs.back().first, ladder.rungs.back().second);
  }
  for (int t = 0; t < 3; ++t) {
    auto& candidates = outcome.candidates[t];
    for (const Ladder& ladder : outcome.ladders)
      if (auto candidate = search.first(method, ladder, targets[t], hopeless * least_work[t]))
        candidates.push_back(*candidate);
  }
  return outcome;
}

void print_ladder(const Ladder& ladder, bool last) {
  std::printf("    {\"iterations\": %d, \"steps\": [", ladder.iterations);
  for (std::size_t i = 0; i < ladder.rungs.size(); ++i)
    std::printf("%s%d", i ? ", " : "", ladder.rungs[i].first);
  std::printf("], \"rms_error_m\": [");
  for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
    const double error = ladder.rungs[i].second;
    std::printf(std::isfinite(error) ? "%s%.2e" : "%snull", i ? ", " : "", error);
  }
  std::printf("], \"ended\": \"%s\"}%s\n",
              ladder.rungs.back().second <= targets[2] * size ? "reached the last target"
              : ladder.too_slow ? "a shorter step is too much work for this error"
                                : "a shorter step is no better",
              last ? "" : ",");
}

void print_target(const Outcome& outcome, int t) {
  const auto& candidates = outcome.candidates[t];
  std::printf("    {\"target\": %g, ", targets[t]);
  if (candidates.empty()) {
    std::printf("\"reached\": false}%s\n", t == 2 ? "" : ",");
    return;
  }
  const Candidate& best = *std::min_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return median(a.samples) < median(b.samples); });
  std::printf(
      "\"reached\": true, \"iterations\": %d, \"steps\": %d, \"dt_s\": %.4e, \"dt_over_u\": %.4f, "
      "\"rms_error_m\": %.2e, \"ms_a_simulated_s\": {\"median\": %.2f, \"min\": %.2f}}%s\n",
      best.setting.iterations, best.setting.steps, end / best.setting.steps,
      end / best.setting.steps / test::cloth_unit, best.error, median(best.samples),
      *std::min_element(best.samples.begin(), best.samples.end()), t == 2 ? "" : ",");
}

}  // namespace

int main() {
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  const reference::World world = *reference::make_world(test::swinging_cloth(Method::rk4, 1.0), 0.0);
  const auto truth = reference::trajectory(world, {end}, test::cloth_unit / 100);
  if (!truth) return std::fprintf(stderr, "%s\n", truth.error().text().c_str()), 1;

  Search search(truth->states[0].position);
  std::vector<Outcome> outcomes;
  for (const Method method : scene::methods) outcomes.push_back(search_all(search, method));
  for (int round = 0; round < rounds; ++round)
    for (Outcome& outcome : outcomes)
      for (auto& candidates : outcome.candidates)
        for (Candidate& candidate : candidates) time_once(candidate);

  std::printf(
      "{\n \"what\": \"cheapest settings for an RMS position error at 0.3 s of the swinging 17 x 17 "
      "cloth\",\n"
      " \"renderer\": \"%s\",\n \"size_m\": %g, \"u_s\": %.6e, \"reference_error_m\": %.1e, \"rounds\": %d,\n"
      " \"methods\": [\n",
      (*context)->device().name.c_str(), size, test::cloth_unit, truth->error[0], rounds);
  for (const Outcome& outcome : outcomes) {
    std::printf("  {\"method\": \"%s\", \"targets\": [\n", scene::name(outcome.method));
    for (int t = 0; t < 3; ++t) print_target(outcome, t);
    std::printf("   ], \"ladders\": [\n");
    for (const Ladder& ladder : outcome.ladders) print_ladder(ladder, &ladder == &outcome.ladders.back());
    std::printf("   ]}%s\n", &outcome == &outcomes.back() ? "" : ",");
  }
  std::printf(" ]\n}\n");
}
