// The fuzz targets' decoder, written from the protocol's table alone, against the server's messages.
#include "server/decode/frame.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "server/stream/packer.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

Result<decode::Decoded> decoded(const stream::SharedMessage& message) {
  return decode::decode_frame({message->data(), message->size()});
}

stream::SharedMessage frame_of(const sim::Simulation& simulation, stream::Encoding encoding,
                               std::uint16_t flags) {
  auto packer = stream::Packer::create();
  REQUIRE(packer);
  REQUIRE((*packer)->request(simulation, encoding, flags));
  return (*packer)->wait();
}

}  // namespace

TEST_CASE(
    "the reference decoder reads the server's frames as the state they show, and writes them byte for byte") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(300);
  const sim::State state = simulation->read_state();
  for (const stream::Encoding encoding : {stream::Encoding::f32, stream::Encoding::q16}) {
    const stream::SharedMessage frame = frame_of(*simulation, encoding, stream::flag_asleep);
    const Result<decode::Decoded> message = decoded(frame);
    INFO((message ? "" : message.error().text()));
    REQUIRE(message);
    CHECK(message->header.vertex_count == 625);
    CHECK(message->header.step == 300);
    CHECK(message->header.time == Approx(0.3));
    CHECK(message->header.flags == 1);
    const std::vector<std::uint8_t> again = decode::encode_frame(*message);
    CHECK(std::equal(again.begin(), again.end(), frame->data(), frame->data() + frame->size()));
    double farthest = 0.0;
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double quantum = static_cast<double>(message->header.box_extent[axis]) / 65535.0;
        const double place =
            encoding == stream::Encoding::f32
                ? static_cast<double>(std::get<decode::Float32>(message->payload).vertices[i][axis])
                : decode::Quantised::position(
                      message->header, std::get<decode::Quantised>(message->payload).vertices[i])[axis];
        const double off = std::abs(place - static_cast<double>(state.position[i][static_cast<int>(axis)]));
        // Half a quantum, and the rounding of float32 where the shader computes it.
        farthest = std::max(farthest, off - (encoding == stream::Encoding::f32 ? 0.0 : 0.5 * quantum + 1e-6));
      }
    }
    CHECK(farthest <= 0.0);
  }
}

TEST_CASE("the reference decoder reads the server's topology, and no part of it alone") {
  scene::Scene scene = test::sheet(4, 3);
  scene.cloths.push_back(scene.cloths[0]);
  const model::Model model = *model::build(scene);
  const stream::SharedMessage message = stream::encode_topology(model, 5);
  const Result<decode::Decoded> read = decoded(message);
  INFO((read ? "" : read.error().text()));
  REQUIRE(read);
  CHECK(read->header.topology_revision == 5);
  const auto& topology = std::get<decode::Topology>(read->payload);
  CHECK(topology.triangles == model.triangles);
  REQUIRE(topology.cloths.size() == 2);
  CHECK(topology.cloths[1] == std::array<std::uint32_t, 2>{12, 12});
  CHECK(topology.texture_coordinates[11] == std::array<float, 2>{1.0f, 1.0f});
  for (std::size_t part = 0; part < message->size(); ++part)
    CHECK_FALSE(decode::decode_frame({message->data(), part}));
}
