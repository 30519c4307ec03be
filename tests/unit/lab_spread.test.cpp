// The lab's verdicts on noisy timings. The timings are made up, so that no machine decides whether these
// tests pass.
#include <algorithm>
#include <cmath>
#include <random>

#include "server/lab/measure/spread.h"
#include "tests/catch.h"

using namespace clothlab;
using namespace clothlab::lab;

namespace {

/// Made-up timings of things that really take `cost`, with a law of noise.
struct Machine {
  std::vector<double> cost;
  std::function<double(std::mt19937&)> noise;  ///< a factor
  std::mt19937 random;
  int timed = 0;

  std::vector<CostComparison> compare(std::vector<CostComparison> comparisons) {
    const auto time = [this](std::size_t thing) -> Result<double> {
      ++timed;
      return cost[thing] * noise(random);
    };
    REQUIRE(take_turns(cost.size(), comparisons, time, [] { return true; }));
    return comparisons;
  }
};

double even(std::mt19937& random) {
  return std::max(0.1, 1.0 + 0.1 * std::normal_distribution<>()(random));
}

/// Mostly quiet; in every fifth timing something else takes up to three times as long.
double bursts(std::mt19937& random) {
  const double at = std::uniform_real_distribution<>()(random);
  return 1.0 + 0.02 * std::uniform_real_distribution<>()(random) +
         (at < 0.2 ? 2.0 * std::uniform_real_distribution<>()(random) : 0.0);
}

/// Number of comparisons, of 1000, that end with this verdict. One thing costs `cost` times the other.
int count(double cost, const std::function<double(std::mt19937&)>& noise, Saving verdict) {
  int found = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Machine machine{{1.0, cost}, noise, std::mt19937(seed)};
    found += machine.compare({{1, 0}}).front().saving == verdict ? 1 : 0;
  }
  return found;
}

}  // namespace

TEST_CASE("a thing that costs the same is not called cheaper under any noise") {
  // At the ratio that is just worth it a look errs with a chance of 3e-4, three looks with at most 9e-4: more
  // than 5 of 1000 come with a chance of 4e-4. A thing that saves nothing at all is farther off.
  for (const auto& noise : {even, bursts}) {
    CHECK(count(largest_worthwhile_ratio, noise, Saving::yes) <= 5);
    CHECK(count(largest_worthwhile_ratio, noise, Saving::no) <= 5);
    CHECK(count(1.0, noise, Saving::yes) == 0);
  }
}

TEST_CASE("a saving of a fifth is found in noise of a tenth, and never denied") {
  // The ratio's noise is 0.8 x 14 %; of 48 rounds the interval ends at the 36th or 37th, 0.7 deviations or
  // 0.08 above 0.8, give or take 0.02: three of these below 0.95.
  CHECK(count(0.8, even, Saving::yes) >= 990);
  CHECK(count(0.8, even, Saving::no) == 0);
  CHECK(count(0.5, bursts, Saving::yes) >= 990);
}

TEST_CASE("where the noise is larger than the saving, it is said that nothing can be told") {
  const auto wild = [](std::mt19937& random) { return std::exp(1.5 * std::normal_distribution<>()(random)); };
  CHECK(count(0.9, wild, Saving::cannot_tell) >= 990);
}

TEST_CASE("a clear verdict takes no more rounds than the first look, an unclear one takes them all") {
  Machine machine{{1.0, 0.2, 2.0}, bursts, std::mt19937(1)};
  machine.noise = [](std::mt19937&) { return 1.0; };
  const auto clear = machine.compare({{1, 0}, {2, 0}});
  CHECK(clear[0].saving == Saving::yes);
  CHECK(clear[1].saving == Saving::no);
  CHECK(machine.timed == 3 * rounds_at_look[0]);
  machine.timed = 0;
  machine.cost[1] = largest_worthwhile_ratio * 0.999;
  machine.noise = even;
  CHECK(machine.compare({{1, 0}, {2, 0}})[0].saving == Saving::cannot_tell);
  // The third is decided at the first look, and is timed no more.
  CHECK(machine.timed == 2 * rounds_at_look[2] + rounds_at_look[0]);
  machine.timed = 0;
  CHECK(machine.compare({{1, 0, false}})[0].saving == Saving::cannot_tell);
  CHECK(machine.timed == 3 * rounds_at_look[0]);
}

TEST_CASE("a machine that slows down while it is timed flatters nothing") {
  for (const double slower : {1.01, 0.99}) {  // with each timing
    double speed = 1.0;
    Machine machine{{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, {}, std::mt19937(1)};
    machine.noise = [&](std::mt19937& random) {
      speed *= slower;
      return speed * (1.0 + 0.01 * std::normal_distribution<>()(random));
    };
    for (const CostComparison& each : machine.compare({{1, 0}, {3, 0}, {6, 0}}))
      CHECK(each.saving != Saving::yes);
  }
}

TEST_CASE(
    "the interval of a median is without end where there are too few values, and else lies among them") {
  CHECK(std::isinf(spread_of({}, 0.01).high));
  CHECK(std::isinf(spread_of({1, 2, 3}, 0.01).high));
  CHECK(spread_of({3, 1, 2}, 0.01).median == 2.0);
  // the chance that all are on one side: 1 / 128
  const Spread seven = spread_of({7, 1, 6, 2, 5, 3, 4}, 0.01);
  CHECK(seven.low == 1.0);
  CHECK(seven.median == 4.0);
  CHECK(seven.high == 7.0);
  const Spread nine =
      spread_of({1, 2, 3, 4, 5, 6, 7, 8, 9}, 0.02);  // (1 + 9) / 512 on the far side of the second
  CHECK(nine.low == 2.0);
  CHECK(nine.high == 8.0);
}
