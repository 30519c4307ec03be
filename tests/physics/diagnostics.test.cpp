// Energies, strain and speed as the GPU sums them, against sums over the same state in double precision.
#include <algorithm>
#include <cmath>

#include "shaders/elements/elements.h"
#include "tests/scenes.h"
#include "tests/small_scenes.h"
#include "tests/spring_laws.h"

using namespace clothlab;

TEST_CASE("diagnostics are the sums over the state: energies, largest strain and speed, contacts") {
  const auto context = test::context();
  const scene::Scene seed = test::seed();
  const auto simulation = test::simulation(seed);
  simulation->step(900);
  const sim::Diagnostics found = simulation->diagnose();
  const sim::State state = simulation->read_state();
  const model::Model& model = simulation->model();

  double kinetic = 0.0, elastic = 0.0, gravitational = 0.0, strain = 0.0, speed = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i) {
    const glm::dvec3 x(state.position[i]), v(state.velocity[i]);
    speed = std::max(speed, glm::length(v));
    if (model.pin_motion[i] != model::not_pinned) continue;
    kinetic += 0.5 * model.mass[i] * glm::dot(v, v);
    gravitational -= model.mass[i] * glm::dot(seed.gravity, x);
  }
  std::vector<glm::dvec3> force(model.vertex_count(), glm::dvec3(0.0));
  for (const model::Spring& spring : model.springs()) {
    const auto [a, b] = spring.vertices;
    const glm::dvec3 x(state.position[a]), y(state.position[b]);
    const glm::dvec3 on_a =
        test::spring_force(x, y, state.velocity[a], state.velocity[b], spring.law.rest_length,
                           spring.law.stiffness, spring.law.damping);
    force[a] += on_a;
    force[b] -= on_a;
    elastic += test::spring_energy(x, y, spring.law.rest_length, spring.law.stiffness);
    strain = std::max(strain, test::spring_strain(x, y, spring.law.rest_length));
  }
  double pin_force = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] != model::not_pinned) pin_force += glm::length(force[i]);
  // Sums of 128 float32 values a group, each rounded: 128 * 6e-8. A stretch is a difference of lengths near
  // 0.04 from positions near 1, each rounded to 6e-8: 1.5e-6 of the length, against strains of some
  // hundredths, squared.
  CHECK(found.kinetic == Approx(kinetic).epsilon(1e-5));
  CHECK(found.gravitational == Approx(gravitational).epsilon(1e-5));
  CHECK(found.elastic == Approx(elastic).epsilon(2e-4));
  CHECK(found.max_strain == Approx(strain).margin(5e-6));
  CHECK(found.max_speed == Approx(speed).epsilon(1e-6));
  CHECK(found.time == Approx(0.9));
  CHECK(found.step == 900);
  CHECK(found.finite);
  CHECK(found.contacts > 0);  // the cloth lies on the ball by now
  // Both pins swing; forces are differences of the same lengths as above, of 20000 N/m.
  CHECK(found.pin_force == Approx(pin_force).epsilon(1e-3));
  CHECK(found.contact_mass == Approx(0.1 * found.contacts).epsilon(1e-5));
  CHECK(found.contact_force >= 9.8 * found.contact_mass * (1 - 1e-5));
}

TEST_CASE("a flat sheet of finite elements has no elastic energy at rest, however it is pinned") {
  const auto context = test::context();
  const auto edge = [](int row) { return scene::Pin{scene::AtEdge{scene::AtEdge::Line::row, row}, {}}; };
  for (const scene::Method method : {scene::Method::verlet, scene::Method::xpbd, scene::Method::vbd}) {
    for (const std::vector<scene::Pin>& pins :
         {std::vector<scene::Pin>{}, {edge(0)}, {edge(0), edge(1)}, {edge(0), edge(2), edge(4), edge(9)}}) {
      scene::Scene scene = test::sheet_of_elements(method, 1e-4, 10);
      std::get<scene::Fem>(scene.cloths[0].material).bending = {1e-3, 4e-3, std::nullopt};
      scene.cloths[0].pins = pins;
      const auto simulation = test::simulation(scene);
      // Terms of either sign, each rounded by 2^-24 in squares, products and sums of some ten terms.
      double terms = 0.0;
      const model::Model& model = simulation->model();
      for (const auto& pair : model.elements.of<elements::Bending>())
        terms += std::abs(element_energy(pair.law, model::edges(pair, 0, model.rest_position)));
      INFO(scene::name(method) << ", " << pins.size() << " pinned rows, terms of " << terms << " J");
      CHECK(terms > 1e-4);
      CHECK(std::abs(simulation->diagnose().elastic) < 10 * 0x1p-24 * terms);
    }
  }
}

TEST_CASE("a value that is not finite is told, wherever it is") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(25, 25);
  scene.cloths[0].pins = {{scene::AtVertex{0}, {}}};
  scene.solver.dt = 0.01;  // seven times the limit of about 1.4 ms
  const auto simulation = test::simulation(scene);
  REQUIRE(simulation->diagnose().finite);
  simulation->step(2000);
  REQUIRE_FALSE(simulation->diagnose().finite);
}
