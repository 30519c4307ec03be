// The fields of frames (server/stream/form.h): a number at each vertex, against the state that it is of.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/vec2.hpp>
#include <limits>

#include "server/stream/packer.h"
#include "tests/scenes.h"

using namespace clothlab;
using stream::Encoding, stream::Field;

namespace {

struct Shown {
  float range = 0;
  std::vector<std::uint8_t> bytes;
  /// [vertex]
  double value(std::size_t i) const { return static_cast<double>(range) * bytes[i] / 255.0; }
  double half_quantum() const { return 0.5 * static_cast<double>(range) / 255.0 * (1 + 1e-5); }
};

std::unique_ptr<stream::Packer> packer() {
  auto made = stream::Packer::create();
  INFO((made ? "" : made.error().text()));
  REQUIRE(made);
  return std::move(*made);
}

Shown shown(stream::Packer& packer, const sim::Simulation& simulation, stream::Form form) {
  REQUIRE(packer.request(simulation, form, 0));
  const stream::SharedMessage frame = packer.wait();
  REQUIRE(frame);
  const std::size_t count = simulation.model().vertex_count();
  REQUIRE(frame->size() == stream::header_bytes + count * form.bytes_per_vertex());
  Shown read;
  std::memcpy(&read.range, frame->data() + 60, sizeof read.range);
  REQUIRE(read.range == frame->header.range);
  read.bytes.assign(frame->data() + frame->size() - count, frame->data() + frame->size());
  return read;
}

Shown shown(const sim::Simulation& simulation, Field field) {
  return shown(*packer(), simulation, {Encoding::q16, field});
}

/// Checks that a range is the value, or up to a quarter of a power of two more.
void check_range(float range, double largest) {
  CHECK(static_cast<double>(range) >= largest * (1 - 1e-6));
  CHECK(static_cast<double>(range) <= largest * 1.25);
  const float quarters = std::ldexp(range, 2 - std::ilogb(range));
  CHECK(quarters == std::round(quarters));
}

using Flat = glm::dvec2;  // seen from above

double turn(Flat a, Flat b, Flat c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
bool within(Flat x, Flat a, Flat b, Flat c) {
  const double first = turn(a, b, x), second = turn(b, c, x), third = turn(c, a, x);
  return (first > 0 && second > 0 && third > 0) || (first < 0 && second < 0 && third < 0);
}
bool cross(Flat a, Flat b, Flat c, Flat d) {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

/// The vertices of two level sheets within the thickness of each other that touch as surfaces do: a corner
/// over the inside of a triangle, or an edge across another.
std::vector<bool> touching_surfaces(const model::Model& model, const sim::State& state) {
  std::vector<bool> touching(model.vertex_count(), false);
  const auto seen = [&](std::uint32_t i) { return Flat(state.position[i].x, state.position[i].z); };
  const auto touch = [&](const std::array<std::uint32_t, 4>& vertices) {
    for (const std::uint32_t i : vertices) touching[i] = true;
  };
  for (const auto& t : model.triangles) {
    for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
      if (model.vertex_cloth[i] != model.vertex_cloth[t[0]] &&
          within(seen(i), seen(t[0]), seen(t[1]), seen(t[2])))
        touch({i, t[0], t[1], t[2]});
    for (const auto& u : model.triangles)
      for (std::size_t k = 0; k < 9 && model.vertex_cloth[t[0]] != model.vertex_cloth[u[0]]; ++k) {
        const std::array<std::uint32_t, 4> edges{t[k / 3], t[(k / 3 + 1) % 3], u[k % 3], u[(k % 3 + 1) % 3]};
        if (cross(seen(edges[0]), seen(edges[1]), seen(edges[2]), seen(edges[3]))) touch(edges);
      }
  }
  return touching;
}

/// Two level sheets of 9 x 9 vertices, 0.5 m wide: the second lies over the half x > 0 of the first, within
/// the thickness of it, each vertex beside one of the first by `shift` [m] along both axes. Neither is held.
scene::Scene half_over(scene::ContactKind kind, double shift) {
  scene::Scene scene = test::sheet(9, 9);
  scene.cloths[0].mesh = scene::Grid{9, 9, 0.5, 0.5};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "over";
  scene.cloths[1].transform.translate = {0.25 + shift, 1.008, shift};
  scene.self_collision = scene::SelfCollision{0.01, 0.2};
  scene.self_collision->kind = kind;
  scene.solver.dt = 1e-4;
  return scene;
}

}  // namespace

TEST_CASE("a frame without a field has the bytes that it always had, whatever others ask for") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(300);
  const auto alone = packer(), shared = packer();
  for (const Encoding encoding : {Encoding::f32, Encoding::q16}) {
    REQUIRE(alone->request(*simulation, encoding, 0));
    const stream::SharedMessage expected = alone->wait();
    shown(*shared, *simulation, {encoding, Field::strain});
    REQUIRE(shared->request(*simulation, encoding, 0));
    const stream::SharedMessage frame = shared->wait();
    REQUIRE(frame->size() == stream::header_bytes + 625 * facts(encoding).bytes_per_vertex);
    const auto same_from = [&](std::size_t begin, std::size_t end) {
      return std::equal(frame->data() + begin, frame->data() + end, expected->data() + begin);
    };
    CHECK(same_from(0, 8));
    CHECK(same_from(12, frame->size()));  // the number at 8 counts frames
    // With a field: the same vertices before it.
    REQUIRE(shared->request(*simulation, {encoding, Field::speed}, 0));
    const stream::SharedMessage with = shared->wait();
    CHECK(std::equal(expected->data() + 64, expected->data() + expected->size(), with->data() + 64));
  }
}

TEST_CASE("in free fall every vertex has the speed g t") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::sheet(7, 5));  // 35 vertices: not a multiple of 4
  simulation->step(250);
  const double speed = 9.8 * 0.25;
  const Shown field = shown(*simulation, Field::speed);
  check_range(field.range, speed);
  // 250 sums of float32: 250 * 6e-8 of it at most.
  for (std::size_t i = 0; i < 35; ++i)
    REQUIRE(std::abs(field.value(i) - speed) <= field.half_quantum() + 1e-4);
}

TEST_CASE("a sheet stretched by 10 percent along its rows has that strain at every vertex, of both models") {
  const auto context = test::context();
  scene::Scene springs = test::sheet(6, 5);
  springs.cloths[0].start = scene::Stretch{{1.1, 1.0, 1.0}};
  scene::Scene sheet = springs;
  sheet.cloths[0].material = scene::Fem{};
  for (const scene::Scene& scene : {springs, sheet}) {
    const auto simulation = test::simulation(scene);
    const Shown field = shown(*simulation, Field::strain);
    check_range(field.range, 0.1);
    for (std::size_t i = 0; i < 30; ++i)
      REQUIRE(std::abs(field.value(i) - 0.1) <= field.half_quantum() + 1e-5);
    CHECK(simulation->diagnose().max_strain == Approx(0.1).margin(1e-5));
  }
}

TEST_CASE("strain is that of the elements at the vertex, and of no other") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(4, 2);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].start = scene::Stretch{{1.0, 1.0, 1.2}};
  const auto simulation = test::simulation(scene);
  const Shown field = shown(*simulation, Field::strain);
  for (std::size_t i = 0; i < 8; ++i) REQUIRE(field.bytes[i] == 0);
  for (std::size_t i = 8; i < 16; ++i) REQUIRE(std::abs(field.value(i) - 0.2) <= field.half_quantum() + 1e-5);
}

TEST_CASE("contact lights exactly the vertices that touch a box under half of a sheet") {
  const auto context = test::context();
  for (const scene::ContactKind kind : {scene::ContactKind::points, scene::ContactKind::surface}) {
    scene::Scene scene = test::sheet(9, 9);
    scene.cloths[0].pins = {{scene::AtVertex{0}, {}}};  // above the box, but held: not in contact
    scene::Box box;
    box.center = {-0.6, 0.9, 0.5};
    box.half = {0.5375, 0.1, 2.0};  // to x = -0.0625, midway between two columns
    scene.colliders = {{"table", box, 0.3, 0.0, {}}};
    scene.self_collision = scene::SelfCollision{0.01, 0.2};
    scene.self_collision->kind = kind;
    const auto simulation = test::simulation(scene);
    const auto pack = packer();
    const Shown before = shown(*pack, *simulation, {Encoding::q16, Field::contact});
    CHECK(std::count(before.bytes.begin(), before.bytes.end(), 0) == 81);
    simulation->step(2);
    const Shown field = shown(*pack, *simulation, {Encoding::q16, Field::contact});
    CHECK(field.range == 1.0f);
    // Among surfaces the box's rim touches the edges between the columns beside it, and so both ends of them.
    const std::size_t columns = kind == scene::ContactKind::surface ? 5 : 4;
    for (std::size_t i = 0; i < 81; ++i) {
      INFO("vertex " << i << " of row " << i / 9 << ", column " << i % 9);
      const bool over = i % 9 < columns && i != 0;
      REQUIRE(field.bytes[i] == (over ? 255 : 0));
    }
    CHECK(simulation->diagnose().contacts == columns * 9 - 1);
  }
}

TEST_CASE("under points, contact lights exactly the vertices of both layers where cloth lies on cloth") {
  const auto context = test::context();
  const auto simulation = test::simulation(half_over(scene::ContactKind::points, 0.0));
  simulation->step(2);
  const Shown field = shown(*simulation, Field::contact);
  for (std::size_t i = 0; i < 162; ++i) {
    // They share five columns, each vertex over another.
    const bool touches = i < 81 ? i % 9 >= 4 : (i - 81) % 9 <= 4;
    INFO("vertex " << i);
    REQUIRE(field.bytes[i] == (touches ? 255 : 0));
  }
  CHECK(simulation->diagnose().contacts == 2 * 5 * 9);
}

TEST_CASE("under surface, contact lights exactly the vertices of both layers where cloth lies on cloth") {
  const auto context = test::context();
  const auto simulation = test::simulation(half_over(scene::ContactKind::surface, 0.02));
  const std::vector<bool> touching = touching_surfaces(simulation->model(), simulation->read_state());
  simulation->step(2);
  const Shown field = shown(*simulation, Field::contact);
  for (std::size_t i = 0; i < 162; ++i) {
    INFO("vertex " << i);
    REQUIRE(field.bytes[i] == (touching[i] ? 255 : 0));
  }
  const auto count = std::count(touching.begin(), touching.end(), true);
  CHECK(count > 60);
  CHECK(count < 100);
  CHECK(simulation->diagnose().contacts == static_cast<std::uint32_t>(count));
}

TEST_CASE(
    "a range rises at once, falls slowly in simulated time, has a floor, and starts anew with a scene") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::sheet(5, 5));
  const auto pack = packer();
  const auto range = [&] { return shown(*pack, *simulation, {Encoding::q16, Field::speed}).range; };
  CHECK(range() == 0.01f);
  simulation->step(1000);
  CHECK(range() == 10.0f);  // 9.8 m/s
  sim::State still = simulation->read_state();
  std::fill(still.velocity.begin(), still.velocity.end(), glm::vec3(0.0f));
  simulation->restore(still, 1.0, 1000);
  CHECK(range() == 10.0f);
  simulation->restore(still, 2.0, 2000);
  CHECK(range() == 6.0f);  // 9.8 exp(-1/2) = 5.94
  simulation->restore(still, 3.0, 3000);
  CHECK(range() == 4.0f);  // 3.61
  simulation->restore(still, 100.0, 100000);
  CHECK(range() == 0.01f);
  simulation->step(1000);
  CHECK(range() == 10.0f);
  simulation->reset();
  CHECK(range() == 0.01f);
}

TEST_CASE("a value that is no number is beyond the range, and spoils no other frame") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::sheet(3, 3));
  const sim::State start = simulation->read_state();
  sim::State bad = start;
  bad.velocity[4].y = std::numeric_limits<float>::quiet_NaN();
  bad.velocity[5].y = 1e30f;  // its square is infinite
  simulation->restore(bad, 0.5, 500);
  const auto pack = packer();
  const Shown field = shown(*pack, *simulation, {Encoding::f32, Field::speed});
  CHECK(std::isfinite(field.range));
  CHECK(field.bytes[4] >= 204);  // of a range up to a quarter larger
  CHECK(field.bytes[5] == field.bytes[4]);
  CHECK(field.bytes[3] == 0);
  simulation->restore(start, 0.1, 100);
  CHECK(shown(*pack, *simulation, {Encoding::f32, Field::speed}).range == 0.01f);
}
