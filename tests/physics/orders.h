// Measures how the error of a method falls with dt, on the GPU and in the reference.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "server/reference/trajectory.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

namespace clothlab::test {

/// Makes a scene for a method and a dt.
using SceneOf = std::function<scene::Scene(scene::Method, double)>;

/// One dt of a ladder, on which each dt is half of the one before.
struct Rung {
  int steps = 0;
  double error = 0;  ///< RMS distance to the truth [m]
  double floor = 0;  ///< RMS distance to the reference by the same method and dt: what float32 adds [m]
};

struct Truth {
  std::vector<glm::dvec3> position;
  double error = 0;  ///< estimated error of `position` [m]
};

/// The scene at `time` [s], by RK4 in double precision; the coarser of its two runs takes `steps`.
inline Truth truth(const SceneOf& scene, double time, int steps) {
  const auto world = reference::make_world(scene(scene::Method::rk4, time), 0.0);
  REQUIRE(world);
  const auto found = reference::trajectory(*world, {time}, time / steps);
  REQUIRE(found);
  return {found->states[0].position, found->error[0] / 15};  // a step twice as long has 16 times the error
}

inline std::vector<glm::dvec3> position_after(Side side, const scene::Scene& scene, int steps) {
  Stepped stepped(side, scene);
  stepped.step(steps);
  return stepped.state().position;
}

/// The rungs of the reference and of the GPU, with the same dt.
struct Ladder {
  std::vector<Rung> reference, gpu;
};

/// Climbs `count` rungs; the first takes `coarsest` steps over `time`.
inline Ladder climb(scene::Method method, const SceneOf& scene, double time, int coarsest, int count,
                    const Truth& truth) {
  Ladder ladder;
  for (int steps = coarsest; static_cast<int>(ladder.gpu.size()) < count; steps *= 2) {
    const scene::Scene at_dt = scene(method, time / steps);
    const auto exact = position_after(Side::reference, at_dt, steps);
    const auto found = position_after(Side::gpu, at_dt, steps);
    ladder.reference.push_back({steps, reference::rms_distance(exact, truth.position), 0.0});
    ladder.gpu.push_back(
        {steps, reference::rms_distance(found, truth.position), reference::rms_distance(found, exact)});
  }
  return ladder;
}

}  // namespace clothlab::test
