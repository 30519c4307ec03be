// Frames packed on the GPU against the state that they show.
#include <cmath>
#include <cstring>

#include "server/stream/packer.h"
#include "tests/scenes.h"

using namespace clothlab;
using stream::Encoding;

namespace {

stream::SharedMessage frame_of(const sim::Simulation& simulation, Encoding encoding) {
  auto packer = stream::Packer::create();
  INFO((packer ? "" : packer.error().text()));
  REQUIRE(packer);
  REQUIRE((*packer)->request(simulation, encoding, 0));
  stream::SharedMessage message = (*packer)->wait();
  REQUIRE(message);
  return message;
}

template <class T>
T at(const stream::SharedMessage& message, std::size_t offset) {
  T value;
  REQUIRE(offset + sizeof(T) <= message->size());
  std::memcpy(&value, message->data() + offset, sizeof(T));
  return value;
}

glm::vec3 octahedral_decoded(float x, float y) {
  glm::vec3 n(x, y, 1.0f - std::abs(x) - std::abs(y));
  if (n.z < 0.0f) {
    const float folded_x = (1.0f - std::abs(y)) * (x >= 0.0f ? 1.0f : -1.0f);
    n.y = (1.0f - std::abs(x)) * (y >= 0.0f ? 1.0f : -1.0f);
    n.x = folded_x;
  }
  return glm::normalize(n);
}

/// Area-weighted vertex normals in double precision.
std::vector<glm::dvec3> normals_of(const model::Model& model, const sim::State& state) {
  std::vector<glm::dvec3> normals(model.vertex_count(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : model.triangles) {
    const glm::dvec3 x(state.position[a]), y(state.position[b]), z(state.position[c]);
    for (const std::uint32_t corner : {a, b, c}) normals[corner] += glm::cross(y - x, z - x);
  }
  for (glm::dvec3& normal : normals) normal = glm::normalize(normal);
  return normals;
}

}  // namespace

TEST_CASE(
    "an f32 frame carries the state's own positions and right normals, its header what the contract says") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(600);
  const stream::SharedMessage frame = frame_of(*simulation, Encoding::f32);
  const sim::State state = simulation->read_state();
  const auto normals = normals_of(simulation->model(), state);

  REQUIRE(at<std::uint8_t>(frame, 0) == 2);
  REQUIRE(at<std::uint8_t>(frame, 1) == 0);
  REQUIRE(at<std::uint32_t>(frame, 12) == 625);
  REQUIRE(at<double>(frame, 16) == Approx(0.6));
  REQUIRE(at<std::uint64_t>(frame, 24) == 600);
  REQUIRE(at<std::uint32_t>(frame, 56) == 625 * 24);
  REQUIRE(at<std::uint32_t>(frame, 60) == 0);
  REQUIRE(frame->size() == 64 + 625 * 24);
  for (std::size_t i = 0; i < 625; ++i) {
    REQUIRE(at<glm::vec3>(frame, 64 + 24 * i) == state.position[i]);
    const glm::dvec3 normal(at<glm::vec3>(frame, 64 + 24 * i + 12));
    // Cross products of edges of 4 cm from float32 positions near 1 m: a relative error of about 1e-7 / 0.04
    // per edge.
    REQUIRE(glm::distance(normal, normals[i]) < 1e-4);
  }
}

TEST_CASE("a q16 frame is within half a quantum of the state, its normals within the octahedral quantum") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(600);
  const stream::SharedMessage frame = frame_of(*simulation, Encoding::q16);
  const sim::State state = simulation->read_state();
  const auto normals = normals_of(simulation->model(), state);
  const glm::dvec3 low(at<glm::vec3>(frame, 32)), extent(at<glm::vec3>(frame, 44));
  REQUIRE(frame->size() == 64 + 625 * 8);
  for (std::size_t i = 0; i < 625; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double u = at<std::uint16_t>(frame, 64 + 8 * i + 2 * static_cast<std::size_t>(axis));
      const double decoded = low[axis] + extent[axis] * u / 65535.0;
      // Half a quantum, and one float32 rounding of the box and of the share.
      const double bound = extent[axis] * (0.5 / 65535.0 + 2e-7) + 2e-7;
      REQUIRE(std::abs(decoded - static_cast<double>(state.position[i][axis])) <= bound);
    }
    const glm::vec3 normal =
        octahedral_decoded(static_cast<float>(at<std::int8_t>(frame, 64 + 8 * i + 6)) / 127.0f,
                           static_cast<float>(at<std::int8_t>(frame, 64 + 8 * i + 7)) / 127.0f);
    // Half a quantum of 1/127 in each of two coordinates; the map stretches lengths by less than 2.5.
    REQUIRE(glm::distance(glm::dvec3(normal), normals[i]) < 2.5 * std::sqrt(2.0) * 0.5 / 127.0);
  }
}

TEST_CASE("normals are right on a mesh of 1 mm cells") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(25, 25);
  scene.cloths[0].mesh = scene::Grid{25, 25, 0.024, 0.024};
  scene.cloths[0].transform.rotate = {30.0, 0.0, 20.0};
  const auto simulation = test::simulation(scene);
  const stream::SharedMessage frame = frame_of(*simulation, Encoding::f32);
  const auto normals = normals_of(simulation->model(), simulation->read_state());
  for (std::size_t i = 0; i < 625; ++i)
    // float32 positions near 1 m against edges of 1 mm: 6e-8 / 1e-3, a few times over the faces of a vertex.
    REQUIRE(glm::distance(glm::dvec3(at<glm::vec3>(frame, 64 + 24 * i + 12)), normals[i]) < 1e-3);
  REQUIRE(std::abs(normals[0].y) < 0.9);  // not the direction that replaces a missing normal
}

TEST_CASE("a topology message lists cloths, triangles and texture coordinates") {
  scene::Scene scene = test::sheet(3, 2);
  scene.cloths.push_back(scene.cloths[0]);
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  const stream::SharedMessage message = stream::encode_topology(*model, 7);
  REQUIRE(at<std::uint8_t>(message, 0) == 1);
  REQUIRE(at<std::uint32_t>(message, 4) == 7);
  REQUIRE(at<std::uint32_t>(message, 12) == 12);
  const std::size_t payload = 8 + 2 * 8 + 8 * 12 + 12 * 8;
  REQUIRE(at<std::uint32_t>(message, 56) == payload);
  REQUIRE(message->size() == 64 + payload);
  REQUIRE(at<std::uint32_t>(message, 64) == 8);
  REQUIRE(at<std::uint32_t>(message, 68) == 2);
  REQUIRE(at<std::uint32_t>(message, 72 + 8) == 6);  // the second cloth's first vertex
  REQUIRE(at<std::uint32_t>(message, 88) == 0);      // first triangle: (0,0) (0,1) (1,1)
  REQUIRE(at<std::uint32_t>(message, 92) == 3);
  REQUIRE(at<std::uint32_t>(message, 96) == 4);
  REQUIRE(at<float>(message, message->size() - 4) == 1.0f);  // the last vertex's v
}
