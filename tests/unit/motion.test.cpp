// How fast what moves by itself can be.
#include "server/model/motion.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "tests/catch.h"

using namespace clothlab;
using glm::dvec3;

TEST_CASE("nothing that follows a motion is ever faster than its top speed, and it comes near to it") {
  const dvec3 axis = glm::normalize(dvec3(1.0, 2.0, -0.5)), home(0.4, -0.3, 0.2);
  const scene::Oscillate swing{axis, 0.3, 0.7};
  const scene::Spin spin{axis, dvec3(0.1, 0.0, 0.0), -200.0};
  const dvec3 place(0.7, 0.5, -0.4);
  struct Case {
    const char* name;
    scene::Motion motion;
    double least;  // share of the top speed that is reached
  };
  const Case cases[] = {{"none", {}, 0.0},
                        {"oscillate", swing, 0.999},
                        {"linear", scene::Linear{{1.0, -2.0, 0.5}}, 0.999},
                        {"spin", spin, 0.999},
                        {"placed", scene::Placed{place, {}}, 0.999},
                        {"placed on a swing", scene::Placed{place, swing}, 0.5},
                        {"placed on a spin", scene::Placed{place, spin}, 0.5}};
  for (const auto& [name, motion, least] : cases) {
    INFO(name);
    // By differences of places over a tenth of a millisecond: the glide of a placed pin has no velocity.
    constexpr double step = 1e-4;
    double fastest = 0.0;
    for (double time = 0.0; time < 3.0; time += step)
      fastest = std::max(fastest, glm::distance(model::pose(motion, time + step).place(home),
                                                model::pose(motion, time).place(home)) /
                                      step);
    const double top = model::top_speed(motion, home);
    CHECK(fastest <= top * (1.0 + 1e-6));
    CHECK(fastest >= least * top);
  }
}
