// Sheets that are curved at rest: no energy and no force in any rigid motion of the rest shape, B/2 (change
// of curvature)^2 about it, and the plate's energy in the limit of a flat one. Meshes from model::build.
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "server/model/element_operator.h"
#include "server/model/model.h"
#include "tests/catch.h"
#include "tests/curved.h"

using namespace clothlab;
using namespace clothlab::test;

namespace {

constexpr double stiffness = 1e-3;  ///< of bending, along warp and weft [N m]

scene::Fem material(double twist = 0.5 * stiffness) {
  scene::Fem fem;
  fem.bending = {stiffness, stiffness, twist};
  return fem;
}

model::Model built(const scene::TriangleMesh& mesh, scene::Fem fem = material(),
                   scene::Method method = scene::Method::verlet, const std::vector<scene::Pin>& pins = {}) {
  scene::Scene scene;
  scene.solver.method = method;
  scene.cloths = {curved_cloth(mesh, fem)};
  scene.cloths[0].pins = pins;
  auto model = model::build(scene);
  INFO((model ? "" : model.error().text()));
  REQUIRE(model);
  return *model;
}

using Places = std::vector<dvec3>;

/// Energy of bending alone, and with the membrane [J].
double bending_energy(const model::Model& model, const Places& x) {
  double sum = 0.0;
  for (const auto& pair : model.elements.of<elements::Bending>())
    sum += element_energy(pair.law, model::edges(pair, 0, x));
  for (const auto& rise : model.elements.of<elements::Shell>())
    sum += element_energy(rise.law, model::edges(rise, 0, x));
  return sum;
}
double energy(const model::Model& model, const Places& x) {
  double sum = 0.0;
  model::each_element(model.elements, [&](const auto& element) {
    sum += element_energy(element.law, model::edges(element, 0, x));
  });
  return sum;
}

Places forces(const model::Model& model, const Places& x, const Places& v) {
  Places force(x.size(), dvec3(0.0));
  model::each_element(model.elements, [&](const auto& element) {
    for (std::size_t c = 0; c < element.corners; ++c)
      force[element.vertices[c]] +=
          element_force(law_at(element, c), model::edges(element, c, x), model::edges(element, c, v));
  });
  return force;
}
double largest(const Places& field) {
  double most = 0.0;
  for (const dvec3& f : field) most = std::max(most, glm::length(f));
  return most;
}
Places still(const model::Model& model) {
  return Places(model.rest_position.size(), dvec3(0.0));
}

/// The rest shape turned by 90 degrees about an axis askew, and moved.
Places turned(const Places& rest) {
  const dvec3 axis = glm::normalize(dvec3(1.0, -2.0, 0.5));
  Places result;
  for (const dvec3& p : rest)
    result.push_back(dvec3(1.0, 2.0, -3.0) + axis * glm::dot(axis, p) + glm::cross(axis, p));
  return result;
}
Places flattened(const Places& rest) {
  Places result = rest;
  for (dvec3& p : result) p.y = 0.0;
  return result;
}

scene::TriangleMesh tetrahedron() {
  scene::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

std::vector<scene::TriangleMesh> meshes() {
  return {sphere(3, true),
          sphere(2, false),
          cylinder(12, 6, 0.2, 0.1, 15.0),
          cylinder(12, 6, 0.2, 0.1, 15.0, 0.25),
          folded(8, 4, 0.2, 0.1),
          seam(),
          tetrahedron()};
}

}  // namespace

TEST_CASE("a sheet that is curved at rest has no energy there and no force, wherever it is turned") {
  for (const scene::TriangleMesh& mesh : meshes()) {
    const model::Model model = built(mesh);
    CHECK(model.elements.of<elements::Shell>().size() > 0);
    const Places x = turned(model.rest_position), flat = flattened(model.rest_position);
    // Relative 1e-6 would do; both are of rounding alone.
    CHECK(std::abs(energy(model, x)) < 1e-9 * energy(model, flat));
    CHECK(largest(forces(model, x, still(model))) < 1e-9 * largest(forces(model, flat, still(model))));
    CHECK(bending_energy(model, flat) > 1e-3 * stiffness);
    // Spinning at rest is not damped.
    Places spin;
    for (const dvec3& p : x) spin.push_back(glm::cross(dvec3(3.0, 5.0, -4.0), p));
    CHECK(largest(forces(model, x, spin)) < 1e-9 * largest(forces(model, flat, still(model))));
  }
}

TEST_CASE(
    "a curved sheet has no energy at rest however many of its vertices are pinned, and no less elsewhere") {
  for (const scene::TriangleMesh& mesh : meshes()) {
    std::vector<scene::Pin> pins;
    std::vector<char> held(mesh.vertices.size(), 0);
    // No triangle has three of them, which would make it a clamp.
    for (std::uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
      held[vertex] = 1;
      if (std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                      [&](const auto& t) { return held[t[0]] && held[t[1]] && held[t[2]]; }))
        held[vertex] = 0;
      else
        pins.push_back({scene::AtVertex{vertex}, {}});
    }
    const model::Model free = built(mesh), pinned = built(mesh, material(), scene::Method::verlet, pins);
    const Places flat = flattened(free.rest_position);
    REQUIRE(pins.size() > mesh.vertices.size() / 4);
    CHECK(std::abs(bending_energy(pinned, pinned.rest_position)) < 1e-9 * bending_energy(free, flat));
    // An energy does not ask what holds the vertices.
    CHECK(bending_energy(pinned, flat) == Approx(bending_energy(free, flat)).epsilon(1e-9));
  }
}

TEST_CASE("about a curved rest shape every move costs energy, and a turn of the whole none") {
  std::mt19937 random(1);
  std::normal_distribution<double> around(0.0, 1.0);
  for (const scene::TriangleMesh& mesh : meshes()) {
    scene::Scene scene;
    scene::Fem fem = material();
    fem.warp = fem.weft = 1e-3;  // the membrane must not hide what bending does
    fem.shear = 1e-3;
    scene.cloths = {curved_cloth(mesh, fem)};
    scene.cloths[0].mass = {scene::Mass::Kind::per_vertex, 1.0};
    const model::Model model = *model::build(scene);
    const model::ElementOperator linear(model, scene, model.rest_position);
    const std::size_t count = model.rest_position.size();
    model::Field stiff(count), damped(count);
    const auto work = [&](const Places& y) {
      linear.apply(y, stiff, damped);
      double sum = 0.0;
      for (std::size_t i = 0; i < count; ++i) sum += glm::dot(y[i], stiff[i]);
      return sum;
    };
    Places turn;
    for (const dvec3& p : model.rest_position) turn.push_back(glm::cross(dvec3(0.3, -0.7, 0.6), p));
    double least = 1e300, most = 0.0;
    for (int n = 0; n < 50; ++n) {
      Places y(count);
      for (dvec3& d : y) d = 0.1 * dvec3(around(random), around(random), around(random));
      // Smooth moves, too: stiffness is least there.
      if (n >= 25)
        for (std::size_t i = 0; i < count; ++i) {
          const dvec3 p = 30.0 * model.rest_position[i];
          y[i] = 0.1 * dvec3(std::sin(p.x + n), std::cos(p.z - n), std::sin(p.y + 2 * n));
        }
      least = std::min(least, work(y));
      most = std::max(most, work(y));
    }
    CHECK(least > 0.0);
    CHECK(std::abs(work(turn)) < 1e-9 * most);
  }
}

TEST_CASE("rolled further or less than at rest, a cylinder has B/2 (change of curvature)^2 on every mesh") {
  for (const double shift : {0.0, 0.25})
    for (const double rest : {5.0, 12.0}) {
      // 40 cells: 2.5 mm in 0.1 m. Along z little, so that free edges are at the two curved sides alone.
      const scene::TriangleMesh flat = rectangle(40, 40, 0.1, 0.1, shift);
      scene::TriangleMesh mesh = flat;
      mesh.vertices = rolled(flat.vertices, rest);
      const model::Model model = built(mesh), plate = built(flat);
      REQUIRE(plate.elements.of<elements::Shell>().size() == 0);
      for (const double change : {-2.0, 1.0, 4.0}) {
        const double found = bending_energy(model, rolled(flat.vertices, rest + change));
        const double exact = 0.5 * stiffness * change * change * 0.1 * 0.1;
        // The outermost triangles of the 40 lose a part of their moment at the free edges: below 1/20 in all.
        // Within, cells of 2.5 mm make chords of arcs: (12/m 2.5 mm)^2 = 1e-3.
        INFO("rest " << rest << ", change " << change << ", shift " << shift << ": " << found / exact);
        CHECK(std::abs(found / exact - 1.0) < 0.05);
        // A flat sheet of the same mesh has the same free edges.
        const double flat_energy =
            bending_energy(plate, rolled(flat.vertices, change)) - bending_energy(plate, flat.vertices);
        CHECK(std::abs(found / flat_energy - 1.0) < 5e-3);
      }
    }
}

TEST_CASE("the flatter a sheet is at rest, the more its bending is that of the plate, on every mesh") {
  for (const double shift : {0.0, 0.25}) {
    const scene::TriangleMesh flat = rectangle(10, 10, 0.1, 0.1, shift);
    const model::Model plate = built(flat);
    const auto bent = [](Places x, double more) {
      for (dvec3& p : x) p.y += more * (0.01 * std::sin(40 * p.x) * std::cos(25 * p.z));
      return x;
    };
    double before = 0.0;
    for (const double curvature : {0.8, 0.4, 0.2}) {
      scene::TriangleMesh mesh = flat;
      for (dvec3& p : mesh.vertices) p.y += 0.5 * curvature * (p.x * p.x - p.z * p.z);
      const model::Model shell = built(mesh);
      REQUIRE(shell.elements.of<elements::Shell>().size() > 0);
      const double error = std::abs(bending_energy(shell, bent(mesh.vertices, 0.1)) /
                                        bending_energy(plate, bent(flat.vertices, 0.1)) -
                                    1.0);
      INFO("curvature " << curvature << ": " << error);
      // Slopes are up to 0.1 times the curvature: their squares, and products with the bend's slope of 0.04.
      CHECK(error < 0.1 * curvature);
      if (before > 0.0) CHECK(error < 0.7 * before);
      before = error;
    }
  }
}

TEST_CASE("forces of a curved sheet add up to no push and no turn, however it is crumpled") {
  std::mt19937 random(2);
  std::normal_distribution<double> around(0.0, 0.02);
  for (const scene::TriangleMesh& mesh : meshes()) {
    const model::Model model = built(mesh);
    Places x = model.rest_position;
    for (dvec3& p : x) p += dvec3(around(random), around(random), around(random));
    const Places force = forces(model, x, still(model));
    dvec3 push(0.0), turn(0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      push += force[i];
      turn += glm::cross(x[i], force[i]);
    }
    CHECK(glm::length(push) < 1e-10 * largest(force));
    CHECK(glm::length(turn) < 1e-10 * largest(force));
  }
}

TEST_CASE("the curved triangles that XPBD visits have the energy of the pairs and rises") {
  std::mt19937 random(3);
  std::normal_distribution<double> around(0.0, 0.003);
  for (const scene::TriangleMesh& mesh : meshes()) {
    const model::Model model = built(mesh, material(), scene::Method::xpbd);
    Places x = model.rest_position;
    for (dvec3& p : x) p += dvec3(around(random), around(random), around(random));
    double sum = 0.0;
    for (const auto& element : model.elements.of<elements::Curvature>()) {
      const auto at = [&](std::size_t k) { return x[element.vertices[k]]; };
      const dvec3 normal = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
      for (std::size_t a = 0; a < 3; ++a) {
        dvec3 form = -element.law.rest[a] * normal;
        for (std::size_t k = 0; k < 12; ++k) form += element.law.row[12 * a + k] * at(k);
        sum += 0.5 * glm::dot(form, form);
      }
    }
    CHECK(bending_energy(model, x) == Approx(sum).epsilon(1e-8));
  }
}

TEST_CASE("a clamped arch has the bending of a clamp, and an edge without a neighbour has no moment") {
  // Two rows of pins hold the arch's end: its triangles bend nothing, the next ones bend from their slope.
  scene::Scene scene;
  scene::TriangleMesh mesh = cylinder(20, 4, 0.2, 0.05, 8.0);
  scene.cloths = {curved_cloth(mesh, material())};
  scene.cloths[0].pins = {{scene::AtBox{{-1, -1, -1}, {0.0101, 1, 1}}, {}}};
  const auto model = model::build(scene);
  REQUIRE(model);
  const Places& rest = model->rest_position;
  Places at_rest = forces(*model, rest, still(*model));
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (model->pin_motion[i] != model::not_pinned) at_rest[i] = dvec3(0.0);  // pairs of pins are left out
  CHECK(largest(at_rest) < 1e-9 * largest(forces(*model, flattened(rest), still(*model))));
  const double before = bending_energy(*model, rest);
  // The rest of it rolled to twice the curvature: the free end has no moment, the clamped one the whole.
  Places more = rest;
  const Places flat = rectangle(20, 4, 0.2, 0.05).vertices;
  for (std::size_t i = 0; i < more.size(); ++i)
    if (flat[i].x > 0.0101) {
      const double s = flat[i].x - 0.01, angle = 8.0 * 0.01 + 16.0 * s;
      const dvec3 start = rolled({dvec3(0.01, 0.0, flat[i].z)}, 8.0)[0];
      more[i] = start + dvec3(std::sin(angle) - std::sin(0.08), std::cos(angle) - std::cos(0.08), 0.0) / 16.0;
    }
  const double exact = 0.5 * stiffness * 8.0 * 8.0 * 0.19 * 0.05;
  // A cell of 20 at the free end bears no moment, and chords of (16/m 1 cm)^2 / 12 = 0.2 %.
  CHECK(bending_energy(*model, more) - before == Approx(exact).epsilon(0.08));
  // A single triangle, and two that only touch at a corner: nothing bends.
  scene::TriangleMesh alone;
  alone.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {1, 0, 1}};
  alone.triangles = {{0, 1, 2}, {1, 3, 4}};
  CHECK(built(alone).elements.of<elements::Shell>().empty());
  CHECK(built(alone).elements.of<elements::Bending>().empty());
}
