// GPU time by stage: what is timed, what is not, and that nothing waits for the result.
#include <glad/gl.h>

#include <chrono>

#include "server/gl/stage_timer.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

gl::StageTimes arrived(gl::StageTimer& timer) {
  gl::StageTimes times;
  glFinish();
  timer.poll(times);
  return times;
}

}  // namespace

TEST_CASE("stages are timed in order, and together take no longer than they were waited for") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  gl::StageTimer timer;
  const auto before = std::chrono::steady_clock::now();
  timer.begin();
  simulation->step(20);
  timer.stage("steps");
  timer.stage("nothing");
  timer.end();
  const gl::StageTimes times = arrived(timer);
  const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  REQUIRE(times.size() == 2);
  CHECK(times[0].stage == std::string("steps"));
  CHECK(times[1].stage == std::string("nothing"));
  CHECK(times[0].seconds > 0);
  CHECK(times[1].seconds >= 0);
  CHECK(times[0].seconds + times[1].seconds <= waited);
  CHECK(arrived(timer).size() == 0);  // each is reported once
}

TEST_CASE("only what lies between begin and end is timed, and not anew before its times are taken") {
  const auto context = test::context();
  gl::StageTimer timer;
  timer.stage("not begun");
  timer.end();
  CHECK(arrived(timer).size() == 0);
  timer.begin();
  timer.end();
  CHECK(arrived(timer).size() == 0);  // no stage
  timer.begin();
  timer.stage("first");
  timer.end();
  timer.begin();  // the first is not finished yet
  timer.stage("second");
  timer.end();
  const gl::StageTimes times = arrived(timer);
  REQUIRE(times.size() == 1);
  CHECK(times[0].stage == std::string("first"));
  timer.begin();
  for (std::size_t i = 0; i < gl::StageTimer::most_stages + 3; ++i) timer.stage("one of many");
  timer.end();
  CHECK(arrived(timer).size() == gl::StageTimer::most_stages);
}

TEST_CASE("a simulation's step is timed pass by pass, as its scene has them") {
  const auto context = test::context();
  const auto names = [](scene::Scene scene, scene::Method method, bool strain_limit) {
    scene.solver.method = method;
    if (strain_limit) scene.cloths[0].springs().strain_limit = 0.1;
    const auto simulation = test::simulation(scene);
    gl::StageTimer timer;
    simulation->step(5, &timer);
    std::vector<std::string> found;
    for (const gl::StageTime& time : arrived(timer)) found.emplace_back(time.stage);
    return found;
  };
  using Names = std::vector<std::string>;
  CHECK(names(test::seed(), scene::Method::rk4, false) == Names{"neighbour_search", "rk4"});
  CHECK(names(test::sheet(5, 5), scene::Method::verlet, false) == Names{"verlet"});
  CHECK(names(test::seed(), scene::Method::verlet, true) ==
        Names{"neighbour_search", "verlet", "strain_limit"});
}
