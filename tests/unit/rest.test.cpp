#include "server/session/rest.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "server/model/model.h"
#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;
using session::Rest;

namespace {

/// The hanging strip, with assignments.
scene::Scene strip(const std::vector<std::string>& assignments = {}) {
  Result<scene::Document> document = scene::load_preset("hanging-strip");
  for (const std::string& assignment : assignments) {
    REQUIRE(document);
    document = scene::set_value(*document, assignment);
  }
  REQUIRE(document);
  return document->scene;
}

Rest watching(const scene::Scene& scene) {
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  Rest rest;
  rest.follow(scene, *model);
  return rest;
}

/// Size of the cloth [m]: a picture of it has 720 lines.
double size_of(const Rest& rest) {
  return 720 * 50 * rest.drift();
}

/// Time [s] at which a vertex is found at rest that moves by `x` and is looked at every `period` for
/// `seconds`.
std::optional<double> found_at_rest(Rest& rest, double seconds, const std::function<double(double)>& x,
                                    double period = 1.0 / 60) {
  constexpr double h = 1e-6;
  for (int i = 0; i * period < seconds; ++i) {
    const double t = i * period;
    const double speed = std::abs(x(t + h) - x(t - h)) / (2 * h);
    if (rest.look(t, speed, [&] { return std::vector{glm::vec3(static_cast<float>(x(t)), 0, 0)}; })) return t;
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("a still vertex is at rest after its stretch, and one that moves fast enough to be seen never is") {
  Rest rest = watching(strip());
  const std::optional<double> still = found_at_rest(rest, 60, [](double) { return 0.25; });
  REQUIRE(still);
  CHECK(*still >= rest.stretch());
  CHECK(*still < 1.1 * rest.stretch());  // there are 32 looks per stretch
  rest.disturb();
  CHECK_FALSE(found_at_rest(rest, 60, [&](double t) { return 0.9 * rest.speed() * t; }));
}

TEST_CASE(
    "a swing is not taken for rest at its turning points, however slow, unless it is too small to be seen") {
  const scene::Scene scene = strip();
  Rest rest = watching(scene);
  // A pendulum as long as the cloth's diagonal, the slowest thing that swings.
  const double omega = std::sqrt(glm::length(scene.gravity) / (1.4142 * size_of(rest)));
  const auto rests = [&](double amplitude) {
    rest.disturb();
    return found_at_rest(rest, 120, [&](double t) { return amplitude * std::sin(omega * t); }).has_value();
  };
  // From any start, half a swing goes as far as the amplitude, and never farther than twice that.
  CHECK_FALSE(rests(1.05 * rest.drift()));
  CHECK(rests(0.45 * rest.drift()));
}

TEST_CASE("a steady creep of a pixel in 50 stretches is no rest, one a hair slower is") {
  Rest rest = watching(strip());
  const double pixel = size_of(rest) / 720;
  const double limit = pixel / (50 * rest.stretch());
  CHECK_FALSE(found_at_rest(rest, 120, [&](double t) { return 1.05 * limit * t; }));
  rest.disturb();
  CHECK(found_at_rest(rest, 120, [&](double t) { return 0.85 * limit * t; }));  // it may be seen a look late
}

TEST_CASE("a jitter that is fast and goes nowhere is rest, as far from the origin as float32 resolves it") {
  Rest rest = watching(strip());
  const auto jitter = [](double t) { return 1e-6 * std::sin(1000 * t); };
  CHECK(found_at_rest(rest, 60, jitter));
  rest.disturb();
  CHECK(found_at_rest(rest, 60, [&](double t) { return 1000 + jitter(t); }));
}

TEST_CASE("a scene whose pins or colliders move is never at rest, one whose motions come to nothing is") {
  const auto stands = [](const std::string& motion) {
    Rest rest = watching(strip({"/cloths/0/pins/0/motion=" + motion}));
    return found_at_rest(rest, 60, [](double) { return 0.0; }).has_value();
  };
  CHECK(stands("null"));
  CHECK(stands(R"({"oscillate": {"axis": [0, 0, 1], "amplitude": 0, "frequency": 1}})"));
  CHECK(stands(R"({"oscillate": {"axis": [0, 0, 1], "amplitude": 1, "frequency": 0}})"));
  CHECK(stands(R"({"linear": {"velocity": [0, 0, 0]}})"));
  CHECK(stands(R"({"spin": {"axis": [0, 1, 0], "center": [0, 0, 0], "degrees_per_second": 0}})"));
  CHECK_FALSE(stands(R"({"oscillate": {"axis": [0, 0, 1], "amplitude": 0.1, "frequency": 1}})"));
  CHECK_FALSE(stands(R"({"linear": {"velocity": [0, 1e-9, 0]}})"));
  CHECK_FALSE(stands(R"({"spin": {"axis": [0, 1, 0], "center": [0, 0, 0], "degrees_per_second": 1}})"));
  Rest seed = watching(scene::load_preset("seed")->scene);
  CHECK(seed.driven());
}

TEST_CASE("time that runs fast is looked at often enough before a cloth is called at rest") {
  Rest rest = watching(strip());
  const double period = 0.9 * rest.stretch();  // two looks would cover it
  const std::optional<double> found = found_at_rest(
      rest, 1000, [](double) { return 0.0; }, period);
  REQUIRE(found);
  CHECK(*found >= Rest::least_looks * period - 1e-9);
}

TEST_CASE("without gravity, and on a moon of little, the stretch is longer but not endless") {
  CHECK(watching(strip({"/gravity=[0,0,0]"})).stretch() == 15);
  const double here = watching(strip()).stretch();
  const double moon = watching(strip({"/gravity=[0,-1.6,0]"})).stretch();
  CHECK(moon == Approx(here * std::sqrt(9.8 / 1.6)));
  // The stretch covers half a swing of the slowest pendulum, with room.
  CHECK(here > 3.14159 * std::sqrt(1.4142 * size_of(watching(strip())) / 9.8));
}

TEST_CASE("a vertex that is not finite is not at rest") {
  Rest rest = watching(strip());
  for (int i = 0; i < 1000; ++i)
    CHECK_FALSE(rest.look(0.1 * i, std::nan(""), [] { return std::vector<glm::vec3>(1); }));
}

TEST_CASE("a cloth in gusts is never at rest, one in steady wind may be") {
  const auto in = [](const char* wind) { return watching(strip({std::string("/wind=") + wind})).driven(); };
  CHECK(in(R"({"velocity": [0, 0, 3], "gust": 0.3, "gust_frequency": 0.5})"));
  CHECK_FALSE(in(R"({"velocity": [0, 0, 3]})"));
  CHECK_FALSE(in(R"({"velocity": [0, 0, 3], "gust": 0.3, "gust_frequency": 0})"));
  CHECK_FALSE(in(R"({"velocity": [0, 0, 0], "gust": 0.3, "gust_frequency": 0.5})"));
}

TEST_CASE("surfaces that lie on each other are at rest with what the passes of their contact leave") {
  const Rest without = watching(strip());
  const scene::Scene scene = strip({"/self_collision={\"kind\":\"surface\"}", "/solver/dt=0.0005"});
  Rest rest = watching(scene);
  CHECK(rest.drift() > without.drift());
  CHECK(rest.speed() > without.speed() + glm::length(scene.gravity) * scene.solver.dt);
  CHECK(found_at_rest(rest, 60, [&](double t) { return 0.9 * rest.drift() * t / rest.stretch(); }));
  rest.disturb();
  CHECK_FALSE(found_at_rest(rest, 60, [&](double t) { return 1.2 * rest.drift() * t / rest.stretch(); }));
}
