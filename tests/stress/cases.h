// The stress scenes, the knob that is turned up in each until a method fails, and the check that a run must
// pass.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/scene/document.h"
#include "server/scene/method.h"

namespace clothlab::stress {

/// The check that a run must pass to hold; its numbers must also stay finite and its motion bounded.
enum class Check {
  settles,    ///< comes to rest at the reference's rest shape
  untangles,  ///< comes to rest, at the reference's rest shape or crumpled: both are counted
  bounded,    ///< no further condition
  falls,      ///< as one piece, as far as gravity takes it
  struck,     ///< no vertex inside the sphere, the middle vertex ahead of it
  pulled      ///< stays above the table and is stretched no more than in the true motion
};

/// The number that is turned up: the scene's dt, or another number at the scene's dt. The worst value comes
/// first.
struct Knob {
  std::string name, unit;
  std::vector<double> values;
  std::function<void(scene::Scene&, double)> set;
};

struct Case {
  std::string name, file;
  Check check;
  double seconds;  ///< of simulated time
  Knob knob;
  std::vector<std::uint32_t> seeds = {1};  ///< of a scattered start: one run each
};

inline scene::Scene load(const std::string& file) {
  return scene::load(CLOTHLAB_SOURCE_DIR "/tests/stress/" + file + ".json")->scene;
}

inline Knob time_step() {
  return {"dt", "s", {1.0 / 30, 1.0 / 60, 1.0 / 120}, [](scene::Scene& scene, double dt) {
            scene.solver.dt = dt;
          }};
}

inline Knob stiffness() {
  return {"stiffness", "N/m", {1e8, 1e7, 1e6, 1e5, 1e4, 1e3, 1e2, 1e1}, [](scene::Scene& scene, double k) {
            scene.solver.dt = 1.0 / 30;
            scene::Springs& material = scene.cloths[0].springs();
            material.structural = material.shear = material.bend = k;
          }};
}

inline Knob mass_ratio() {
  return {"mass ratio", "", {1e4, 1e3, 1e2, 1e1}, [](scene::Scene& scene, double ratio) {
            scene.solver.dt = 1.0 / 30;
            scene.cloths[0].weights[0].mass = (ratio - 1) * scene.cloths[0].mass.value;
          }};
}

/// At a step that every method stands: 0.5 ms is a third of the limit.
inline Knob distance() {
  return {"distance", "m", {1e5, 1e4, 1e3, 1e2, 1e1}, [](scene::Scene& scene, double x) {
            scene.solver.dt = scene::any_step_is_stable(scene.solver.method)         ? 1.0 / 120
                              : scene.solver.method == scene::Method::explicit_euler ? 2e-4
                                                                                     : 5e-4;
            scene.cloths[0].transform.translate.x = x;
          }};
}

inline Knob sphere_at(double speed) {
  Knob knob = time_step();
  knob.set = [speed](scene::Scene& scene, double dt) {
    scene.solver.dt = dt;
    scene.colliders[0].motion = scene::Linear{{0.0, 0.0, speed}};
  };
  return knob;
}

inline Knob pulled_at(double speed) {
  Knob knob = time_step();
  knob.set = [speed](scene::Scene& scene, double dt) {
    scene.solver.dt = dt;
    scene.cloths[0].pins[0].motion = scene::Linear{{0.0, 0.0, -speed}};
  };
  return knob;
}

inline std::vector<Case> cases() {
  std::vector<Case> all = {
      {"level sheet let go", "level", Check::settles, 6, time_step()},
      {"random start", "random", Check::untangles, 6, time_step(), {1, 2, 3}},
      {"all vertices in a point", "point", Check::untangles, 6, time_step()},
      {"on a line", "line", Check::untangles, 6, time_step()},
      {"in a plane", "plane", Check::settles, 6, time_step()},
      {"stiffness 1e8", "stiff", Check::settles, 6, time_step()},
      {"stiffness, at dt = 1/30 s", "level", Check::settles, 6, stiffness()},
      {"one vertex 1e4 times heavier", "heavy", Check::settles, 6, time_step()},
      {"one heavy vertex, at dt = 1/30 s", "heavy", Check::settles, 6, mass_ratio()},
      {"stiffness ratio 1e6", "ratio", Check::settles, 6, time_step()},
      {"no damping at all", "undamped", Check::bounded, 6, time_step()},
      {"far from the origin", "level", Check::settles, 6, distance()},
      {"free fall of a light sheet", "light", Check::falls, 1.0, time_step()},
      {"twist of 2 x 72 degrees/s", "twist", Check::pulled, 2.5, time_step()},
  };
  for (const double speed : {1.0, 5.0, 10.0, 50.0})
    all.push_back({"sphere at " + std::to_string(static_cast<int>(speed)) + " m/s", "sphere", Check::struck,
                   0.8 / speed, sphere_at(speed)});
  for (const double speed : {1.0, 2.0, 4.0, 8.0})
    all.push_back({"table-cloth pulled at " + std::to_string(static_cast<int>(speed)) + " m/s", "tablecloth",
                   Check::pulled, 1.0 / speed, pulled_at(speed)});
  return all;
}

}  // namespace clothlab::stress
