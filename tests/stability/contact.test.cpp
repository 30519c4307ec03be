// A cloth that lies, slides or lands gains no energy below the step limit: contact adds none.
#include <algorithm>
#include <cmath>

#include "server/model/stability.h"
#include "tests/resting.h"
#include "tests/sides.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

struct Case {
  const char* name;
  scene::Scene scene;
};

std::vector<Case> cases(double friction) {
  std::vector<Case> made;
  made.push_back({"rests", sheet_on_slope(0.0, friction)});
  made.push_back({"slides", sheet_on_slope(25.0, friction)});
  made.push_back({"slides, sheared and bent", sheet_on_slope(25.0, friction)});
  made.back().scene.cloths[0].material = scene::Springs{800.0, 400.0, 50.0, 0.0};
  made.push_back({"slides, damped", sheet_on_slope(25.0, friction)});
  made.back().scene.cloths[0].springs().damping = 0.02;
  made.push_back({"lands", sheet_on_slope(10.0, friction)});
  made.back().scene.cloths[0].transform.translate = {0.0, 0.1, 0.0};
  made.back().scene.cloths[0].transform.rotate = {0.0, 0.0, 10.0};
  made.push_back({"bounces", made.back().scene});
  made.back().scene.colliders[0].restitution = 0.5;
  // Springs that turn stiffen a cloth without shear springs: the limit about its rest shape no longer holds.
  made.push_back({"lands on a ball", sheet_over_sphere(0.05, friction)});
  made.back().scene.cloths[0].material = scene::Springs{800.0, 800.0, 80.0, 0.0};
  made.push_back({"lands on a ball, itself in the way", sheet_over_sphere(0.05, friction)});
  made.back().scene.cloths[0].material = scene::Springs{800.0, 800.0, 80.0, 0.0};
  made.back().scene.self_collision = scene::SelfCollision{0.04, 0.2};
  made.push_back({"hangs by a corner and lies", sheet_on_slope(20.0, friction)});
  made.back().scene.cloths[0].material = scene::Springs{800.0, 800.0, 80.0, 0.0};
  made.back().scene.cloths[0].pins = {{scene::AtCorner{8, 0}, {}}};
  return made;
}

/// Factor by which a vibration's energy may swing about its mean at this share of the limit, as it does in
/// free flight.
double swing(double share) {
  return (1.0 + share) / (1.0 - share);
}

}  // namespace

TEST_CASE("a cloth that rests, slides or lands on a plane or a ball gains no energy up to 0.9 of the limit") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const Method method : {Method::symplectic_euler, Method::verlet, Method::rk4}) {
      for (const double friction : {0.0, 0.3}) {
        for (Case& one : cases(friction)) {
          one.scene.solver.method = method;
          one.scene.solver.dt = 1e-4;
          const model::Model model = *model::build(one.scene);
          const double limit = model::dt_limit(model, one.scene);
          for (const double share : {0.1, 0.35, 0.9}) {
            one.scene.solver.dt = share * limit;
            Stepped stepped(side, one.scene);
            stepped.step(1);  // the ground keeps its margin, and lifts a cloth that lies on it
            const int steps = static_cast<int>(0.7 / one.scene.solver.dt);
            const double start = stepped.energy().total();
            double worst = 0.0;
            for (int n = 0; n < 10; ++n) {
              stepped.step(steps / 10);
              const reference::Energy now = stepped.energy();
              const double fall = std::max(0.0, start - now.gravitational);
              // 1e-4 J: the error of the springs' energy by rounding of the places.
              worst = std::max(worst, (now.kinetic + now.elastic) / (swing(share) * fall + 1e-4));
              if (!std::isfinite(now.total())) worst = 1e300;
            }
            INFO(scene::name(method) << ", " << name(side) << ", friction " << friction << ", " << one.name
                                     << ", " << share << " of the limit: " << worst
                                     << " of the energy there can be");
            CHECK(worst < 1.0);
          }
        }
      }
    }
  }
}
