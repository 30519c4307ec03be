// The watch for blow-ups on energies alone: it finds energy that grows without work, and never reports a
// sound motion.
#include "server/sim/blow_up.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/model/stability.h"
#include "tests/scenes.h"

using namespace clothlab;
using Verdict = sim::BlowUp::Verdict;

namespace {

/// A mass of 1 kg on a spring of 100 N/m (omega = 10/s) whose far end may swing, under symplectic or explicit
/// Euler; the watch looks every `stride` steps.
struct Oscillator {
  bool symplectic = true;
  double dt = 0.01, damping = 0.0, pin_amplitude = 0.0, pin_omega = 0.0;
  double x = 0.0, v = 0.0, time = 0.0;

  double pin() const { return pin_amplitude * std::sin(pin_omega * time); }
  double pin_velocity() const { return pin_amplitude * pin_omega * std::cos(pin_omega * time); }
  void step() {
    const double a = -100.0 * (x - pin()) - damping * (v - pin_velocity());
    const double old = v;
    v += dt * a;
    x += dt * (symplectic ? v : old);
    time += dt;
  }
  sim::Diagnostics look() const {
    sim::Diagnostics state;
    state.time = time;
    state.kinetic = 0.5 * v * v;
    state.elastic = 50.0 * (x - pin()) * (x - pin());
    state.pin_force = std::abs(100.0 * (x - pin()) + damping * (v - pin_velocity()));
    state.finite = std::isfinite(x) && std::isfinite(v);
    return state;
  }
};

sim::Allowance allowed(double share_of_limit, double pin_speed = 0.0) {
  sim::Allowance allowance;
  allowance.slack_energy = 1.0;
  const double s = std::min(share_of_limit, 0.95);
  allowance.energy_ratio = share_of_limit > 1.0 ? 4.0 : std::max(2.0, (1 + s) / (1 - s));
  allowance.pin_speed = pin_speed;
  return allowance;
}

struct Outcome {
  bool blown_up = false;
  double energy = 0.0, good_energy = 0.0;  // kinetic + elastic [J], at the end and in the last good state
  int doubtful = 0;
};

Outcome watch(Oscillator run, const sim::Allowance& allowance, int steps, int stride) {
  sim::BlowUp blow_up;
  blow_up.start(allowance, run.look());
  Outcome outcome;
  for (int i = 0; i < steps && !outcome.blown_up; i += stride) {
    for (int j = 0; j < stride; ++j) run.step();
    const Verdict verdict = blow_up.judge(run.look());
    outcome.blown_up = verdict == Verdict::blown_up;
    if (verdict == Verdict::doubtful) ++outcome.doubtful;
    outcome.energy = run.look().kinetic + run.look().elastic;
  }
  outcome.good_energy = blow_up.last_good().kinetic + blow_up.last_good().elastic;
  return outcome;
}

}  // namespace

TEST_CASE("a vibration just under its step limit swings in energy and never blows up") {
  for (const double share : {0.1, 0.5, 0.9, 0.95}) {
    for (const int stride : {1, 7, 16}) {
      Oscillator run;
      run.dt = share * 0.2;  // 2 / omega
      run.x = 1.0;           // 50 J, far above the slack
      const Outcome outcome = watch(run, allowed(share), 200'000, stride);
      INFO("share " << share << ", stride " << stride);
      CHECK_FALSE(outcome.blown_up);
      CHECK(outcome.doubtful < 180'000 / stride);  // good states are frequent
    }
  }
}

TEST_CASE("just over its limit it is found while the last good state is still small") {
  for (const double share : {1.001, 1.05, 1.5}) {
    Oscillator run;
    run.dt = share * 0.2;
    run.x = 0.001;
    const Outcome outcome = watch(run, allowed(share), 200'000, 2);
    INFO("share " << share << ", energy " << outcome.energy << ", good " << outcome.good_energy);
    CHECK(outcome.blown_up);
    CHECK(outcome.good_energy < 1.0);  // the tolerated growth
    CHECK(outcome.energy < 1e9);       // found long before it is infinite: at 1.5 it grows 47 times per step
  }
}

TEST_CASE("explicit Euler's slow growth is found at a thousandth of the period too") {
  Oscillator run;
  run.symplectic = false;
  run.dt = 0.0006;  // energy grows by (omega dt)^2 = 3.6e-5 a step
  run.x = 0.1;
  const Outcome outcome = watch(run, allowed(2.0), 2'000'000, 16);
  CHECK(outcome.blown_up);
  CHECK(outcome.energy < 100.0);
}

TEST_CASE("a pin that swings at the resonance does the work that it costs, however much") {
  for (const double damping : {0.0, 0.5}) {
    Oscillator run;
    run.dt = 0.002;
    run.damping = damping;
    run.pin_amplitude = 0.1;
    run.pin_omega = 10.0;
    const Outcome outcome = watch(run, allowed(0.01, 1.0), 50'000, 8);
    CHECK_FALSE(outcome.blown_up);
    CHECK(outcome.energy > 5.0);  // the tolerated growth does not hide it
    CHECK(outcome.doubtful == 0);
    // The same energies without a moving pin would be growth from nothing.
    CHECK(watch(run, allowed(0.01, 0.0), 50'000, 8).blown_up);
  }
}

TEST_CASE("a jump in energy that does not grow on is doubted for a while, then taken") {
  sim::Diagnostics state;
  sim::BlowUp blow_up;
  blow_up.start(allowed(0.5), state);
  for (int i = 0; i < 200; ++i) {
    state.time += 1.0 / 60.0;
    state.elastic = i < 10 ? 0.0 : 1000.0 * std::exp(-0.01 * i);
    REQUIRE(blow_up.judge(state) != Verdict::blown_up);
  }
  CHECK(blow_up.judge(state) == Verdict::good);
}

TEST_CASE("a method that may be softer than the cloth is judged by its motion, not by its stretch") {
  sim::Allowance allowance = allowed(0.5);
  for (const bool stretch : {true, false}) {
    for (double sim::Diagnostics::*energy : {&sim::Diagnostics::elastic, &sim::Diagnostics::kinetic}) {
      allowance.counts_elastic = stretch;
      sim::Diagnostics state;
      sim::BlowUp blow_up;
      blow_up.start(allowance, state);
      bool found = false;
      for (int i = 0; i < 100; ++i) {
        state.time += 1.0 / 60.0;
        state.*energy = 1e-3 * std::exp(0.5 * i);
        found = found || blow_up.judge(state) == Verdict::blown_up;
      }
      CHECK(found == (stretch || energy == &sim::Diagnostics::kinetic));
    }
  }
}

TEST_CASE("a state that is not finite has blown up, and the reason says between which times") {
  sim::BlowUp blow_up;
  sim::Diagnostics state;
  blow_up.start(allowed(0.5), state);
  state.time = 0.25;
  REQUIRE(blow_up.judge(state) == Verdict::good);
  sim::Diagnostics broken = state;
  broken.time = 0.5;
  SECTION("a position") {
    broken.finite = false;
  }
  SECTION("an energy beyond float32") {
    broken.kinetic = std::numeric_limits<double>::infinity();
  }
  SECTION("NaN") {
    broken.elastic = std::numeric_limits<double>::quiet_NaN();
  }
  REQUIRE(blow_up.judge(broken) == Verdict::blown_up);
  CHECK(blow_up.reason().find("between t = 0.25 s and t = 0.5 s") != std::string::npos);
  CHECK(blow_up.last_good().time == 0.25);
}

TEST_CASE(
    "a force that overflows before the energies do excuses nothing, at pins and colliders that move or "
    "stand") {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double pin_speed : {0.0, 0.5})
    for (const bool pins : {true, false}) {
      sim::Allowance allowance = allowed(1.5, pin_speed);
      allowance.collider_speed = pin_speed;
      sim::Diagnostics state;
      sim::BlowUp blow_up;
      blow_up.start(allowance, state);
      state.time = 0.06;
      state.kinetic = 2e37;  // within float32
      (pins ? state.pin_force : state.contact_force) = infinite;
      CHECK(blow_up.judge(state) == Verdict::blown_up);
      CHECK(blow_up.last_good().time == 0.0);
      CHECK(blow_up.reason() ==
            "positions, velocities or forces stopped being finite numbers between t = 0 s and t = 0.06 s");
    }
}

TEST_CASE("a change of scene under the state is no growth, and hides none") {
  Oscillator run;
  run.dt = 0.201;  // just over the limit
  run.x = 0.01;
  sim::BlowUp blow_up;
  blow_up.start(allowed(0.9), run.look());
  bool blown_up = false;
  int changes = 0;
  for (; changes < 20'000 && !blown_up; ++changes) {
    run.step();
    blown_up = blow_up.judge(run.look()) == Verdict::blown_up;
    blow_up.rebase(run.look());  // a change that changes nothing, every step
  }
  CHECK(blown_up);

  sim::Diagnostics state;
  state.elastic = 10.0;
  blow_up.start(allowed(0.5), state);
  REQUIRE(blow_up.judge(state) == Verdict::good);
  state.elastic = 10'000.0;  // a thousand times as stiff
  blow_up.rebase(state);
  CHECK(blow_up.judge(state) == Verdict::good);
}

TEST_CASE("a falling cloth, and one that colliders throw and carry, is within the allowance") {
  const scene::Scene seed = test::seed();
  const model::Model model = *model::build(seed);
  const sim::Allowance allowance = sim::allowance(seed, model, 0.0017);
  // 62.3 kg move, 1 m x 1 m; pins at 2 pi 0.5 Hz 0.2 m; dt / limit = 0.588.
  const double lifted = 0.25 * 62.3 * 9.8 * std::sqrt(2.0);
  CHECK(allowance.slack_energy > lifted);
  CHECK(allowance.slack_energy < 2.0 * lifted);
  CHECK(allowance.growth == 4.0);
  CHECK(allowance.pin_speed == Approx(0.2 * 3.14159265).epsilon(1e-6));
  CHECK(allowance.collider_speed == 0.0);
  CHECK(allowance.energy_ratio == Approx((1 + 0.588) / (1 - 0.588)).epsilon(1e-2));
  scene::Scene beyond = seed;
  beyond.solver.dt = 0.0018;  // no doubt is left
  CHECK(sim::allowance(beyond, model, 0.0017).growth == 1.0);
  scene::Scene rolling = seed;
  rolling.colliders[0].motion = scene::Linear{{3.0, 0.0, 4.0}};
  CHECK(sim::allowance(rolling, model, 0.0017).collider_speed == Approx(5.0));
  rolling.colliders[0].motion = scene::Spin{{0.0, 1.0, 0.0}, {0.0, 0.6, 0.0}, 180.0};
  CHECK(sim::allowance(rolling, model, 0.0017).collider_speed == Approx(3.14159265 * 0.25));

  // A cloth far away, pinned, adds nothing but what rounding stretches of its own.
  scene::Scene beside = seed;
  scene::Cloth& far = beside.cloths.emplace_back(seed.cloths[0]);
  far.mesh = scene::Grid{25, 25, 100.0, 100.0};
  far.transform.translate = {1000.0, 0.0, 0.0};
  far.material = scene::Springs{1.0, 1.0, 1.0, 0.0};
  far.pins = {{scene::AtBox{glm::dvec3(-1e4), glm::dvec3(1e4)}, {}}};
  CHECK(sim::allowance(beside, *model::build(beside), 0.0017).slack_energy ==
        Approx(allowance.slack_energy).epsilon(1e-3));

  scene::Scene slower = seed;
  slower.solver.dt = 0.1;
  CHECK_FALSE(sim::changes_energy(seed, slower));
  CHECK(sim::changes_energy(seed, rolling));
}
