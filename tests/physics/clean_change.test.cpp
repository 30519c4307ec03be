// A running cloth that has gone through itself cannot be told to keep its surfaces apart.
#include "tests/crossings.h"
#include "tests/scenes.h"

using namespace clothlab;
using Kind = scene::ContactKind;

TEST_CASE("a cloth that has gone through itself keeps its kind of self-collision until it is reset") {
  const auto context = test::context();
  scene::Scene scene = scene::load_preset("twist")->scene;
  scene.self_collision->kind = Kind::points;
  const auto simulation = test::simulation(scene);
  simulation->step(4000);  // 4 s: more than one and a half turns of one end against the other
  REQUIRE(!test::crossings(simulation->model(), simulation->read_state().position).empty());
  scene.self_collision->kind = Kind::surface;
  const Result<sim::ChangeDepth> refused = simulation->change(scene);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().where == "/self_collision/kind");
  CHECK(refused.error().what.find("the cloth at present has ") != std::string::npos);
  CHECK(refused.error().remedy.find("reset") != std::string::npos);
  CHECK(simulation->scene().self_collision->kind == Kind::points);
  simulation->step(1);
  CHECK(simulation->step_index() == 4001);
  simulation->reset();
  CHECK(simulation->change(scene));
}
