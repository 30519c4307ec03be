// The model's start positions and weights.
#include <algorithm>

#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using glm::dvec3;

namespace {

/// A cloth that stands upright, so that the world's axes are not those of the mesh.
scene::Scene cloth(const scene::Start& start) {
  scene::Scene scene = test::swinging_cloth(scene::Method::symplectic_euler, 1e-3);
  scene.cloths[0].transform = {{1.0, 2.0, 3.0}, {90.0, 0.0, 0.0}, 2.0};
  scene.cloths[0].start = start;
  return scene;
}

model::Model model_of(const scene::Scene& scene) {
  return *model::build(scene);
}

constexpr std::size_t corner = 16;  // pinned, as is 0
const dvec3 centre(1.0, 1.5, 3.0);  // of the rest shape: 1 m of cloth in the x-y plane

}  // namespace

TEST_CASE("without a start a cloth starts in its rest shape") {
  const model::Model model = model_of(cloth({}));
  CHECK(model.start_position == model.rest_position);
}

TEST_CASE("a scattered cloth fills its cube, its pins stay at home, and its springs keep their lengths") {
  const model::Model rest = model_of(cloth({})), model = model_of(cloth(scene::Scatter{0.5, 1}));
  CHECK(model.rest_position == rest.rest_position);
  dvec3 low(1e9), high(-1e9), sum(0.0);
  for (std::size_t i = 0; i < model.vertex_count(); ++i) {
    if (i == 0 || i == corner) {
      CHECK(model.start_position[i] == rest.rest_position[i]);
      continue;
    }
    low = glm::min(low, model.start_position[i]);
    high = glm::max(high, model.start_position[i]);
    sum += model.start_position[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(low[axis] >= centre[axis] - 0.25);
    CHECK(high[axis] <= centre[axis] + 0.25);
    CHECK(high[axis] - low[axis] > 0.48);  // 287 places leave gaps of 0.5 m / 288 at the ends
    // The mean of 287 places strays by 0.5 m / sqrt(12 * 287) = 8.5 mm.
    CHECK(std::abs(sum[axis] / 287 - centre[axis]) < 0.03);
  }
  for (std::size_t s = 0; s < model.springs().size(); ++s)
    CHECK(model.springs()[s].law.rest_length == rest.springs()[s].law.rest_length);
}

TEST_CASE("the same seed scatters to the same places on every machine, another one to others") {
  const model::Model model = model_of(cloth(scene::Scatter{2.0, 1}));
  CHECK(model.start_position == model_of(cloth(scene::Scatter{2.0, 1})).start_position);
  const dvec3 first = (model.start_position[1] - centre) / 2.0;
  CHECK(first.x == Approx(0.19244558487466323).epsilon(1e-12));
  CHECK(first.y == Approx(0.3709137969635957).epsilon(1e-12));
  CHECK(first.z == Approx(-0.03480754937151276).epsilon(1e-12));
  const model::Model other = model_of(cloth(scene::Scatter{2.0, 2}));
  for (std::size_t i = 1; i < corner; ++i)
    CHECK(glm::distance(model.start_position[i], other.start_position[i]) > 1e-3);
}

TEST_CASE("a scaled start is about the middle along the world's axes: flat, a line, a point, larger") {
  for (const dvec3 scale : {dvec3(1, 1, 0), dvec3(1, 0, 1), dvec3(0, 0, 0), dvec3(2, -3, 0.5)}) {
    const model::Model model = model_of(cloth(scene::Stretch{scale}));
    for (std::size_t i = 1; i < model.vertex_count(); ++i) {
      const dvec3 wanted =
          i == corner ? model.rest_position[i] : centre + scale * (model.rest_position[i] - centre);
      CHECK(glm::distance(model.start_position[i], wanted) < 1e-12);
    }
  }
}

TEST_CASE("weights add to the mass of the vertices they are at, and two add up") {
  scene::Scene scene = cloth({});
  scene.cloths[0].weights = {{scene::AtEdge{scene::AtEdge::Line::row, 16}, 0.25},
                             {scene::AtVertex{288}, 1.0}};
  const model::Model plain = model_of(cloth({})), model = model_of(scene);
  for (std::size_t i = 0; i < model.vertex_count(); ++i)
    CHECK(model.mass[i] == Approx(plain.mass[i] + (i >= 272 ? 0.25 : 0.0) + (i == 288 ? 1.0 : 0.0)));
}

TEST_CASE("a weight whose box holds no vertex is refused by its pointer") {
  scene::Scene scene = cloth({});
  scene.cloths[0].weights = {{scene::AtVertex{0}, 1.0}, {scene::AtBox{dvec3(9), dvec3(10)}, 1.0}};
  const auto refused = model::build(scene);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().where == "/cloths/0/weights/1/at");
}

TEST_CASE("the reference starts at the start, and pins and step limits know nothing of it") {
  const reference::World world = world_of(cloth(scene::Scatter{0.5, 1}));
  reference::State state = reference::at_rest(world);
  CHECK(state.position == world.model.start_position);
  reference::step(world, state);
  CHECK(state.position[corner] == world.model.rest_position[corner]);
}
