// The bytes of the protocol in tests/golden: the server makes exactly these of a fixed scene. The files were
// written from server/net/README.md, not by this code. All vertices of the scenes are pinned, and their
// numbers are such that nothing is rounded: f32 has only normals along axes (no other unit vector is exact in
// binary); in q16 positions are whole quanta, and normals far from half a quantum.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <tuple>

#include "server/base/deflate.h"
#include "server/base/files.h"
#include "server/decode/frame.h"
#include "server/stream/compressor.h"
#include "server/stream/packer.h"
#include "tests/scenes.h"

using namespace clothlab;
using stream::Encoding, stream::Field;

namespace {

std::string golden(const std::string& name) {
  const Result<std::string> bytes = read_file(std::string(CLOTHLAB_SOURCE_DIR "/tests/golden/") + name);
  if (!bytes) FAIL(bytes.error().text());
  return *bytes;
}

/// After three steps of 1/8 s, so that time and step are not 0; all vertices are pinned, so nothing else
/// changes.
std::unique_ptr<sim::Simulation> stepped(const std::string& scene) {
  auto simulation = test::simulation(test::document_of(golden(scene)).scene);
  simulation->step(3);
  return simulation;
}

void require_golden(const stream::SharedMessage& message, const std::string& name) {
  REQUIRE(message);
  const std::string made(reinterpret_cast<const char*>(message->data()), message->size());
  const std::string expected = golden(name);
  const auto [differs, in_expected] =
      std::mismatch(made.begin(), made.end(), expected.begin(), expected.end());
  INFO(name << " differs first at byte " << differs - made.begin() << " (the header has 64)");
  REQUIRE(made.size() == expected.size());
  REQUIRE(differs == made.end());
}

/// Checks the frames of one packer, one for each of `flags`, numbered from 1.
void require_frames(const sim::Simulation& simulation, stream::Form form, std::vector<std::uint16_t> flags,
                    const std::vector<std::string>& names) {
  auto packer = stream::Packer::create();
  INFO((packer ? "" : packer.error().text()));
  REQUIRE(packer);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    REQUIRE((*packer)->request(simulation, form, flags[i]));
    require_golden((*packer)->wait(), names[i]);
  }
}

}  // namespace

TEST_CASE("a topology message is the committed bytes") {
  const auto context = test::context();
  const auto simulation = stepped("cloths.scene.json");
  require_golden(stream::encode_topology(simulation->model(), simulation->topology_revision()),
                 "topology.bin");
}

TEST_CASE("f32 frames are the committed bytes, with the diverged flag and without") {
  const auto context = test::context();
  require_frames(*stepped("axes.scene.json"), Encoding::f32, {0, stream::flag_diverged},
                 {"frame-f32.bin", "frame-f32-diverged.bin"});
}

TEST_CASE("q16 frames are the committed bytes, with the asleep flag and without") {
  const auto context = test::context();
  require_frames(*stepped("cloths.scene.json"), Encoding::q16, {0, stream::flag_asleep},
                 {"frame-q16.bin", "frame-q16-asleep.bin"});
}

TEST_CASE("frames with a field are the committed bytes, in both encodings") {
  const auto context = test::context();
  const auto moving = stepped("moving.scene.json");
  require_frames(*moving, {Encoding::f32, Field::speed}, {0}, {"frame-f32-speed.bin"});
  require_frames(*moving, {Encoding::q16, Field::speed}, {0}, {"frame-q16-speed.bin"});
}

// Other versions of zlib may compress otherwise: the header and what the stream holds are compared.
TEST_CASE("c16 frames hold the committed bytes, with a field and without") {
  const auto context = test::context();
  for (const auto& [scene, name, field] :
       {std::tuple("fan.scene.json", "frame-c16.bin", Field::none),
        std::tuple("moving.scene.json", "frame-c16-speed.bin", Field::speed)}) {
    INFO(name);
    const auto simulation = stepped(scene);
    const model::Model& model = simulation->model();
    auto packer = stream::Packer::create();
    REQUIRE(packer);
    REQUIRE((*packer)->request(*simulation, {Encoding::c16, field}, 0));
    const stream::SharedMessage packed = (*packer)->wait();
    REQUIRE(packed);
    const stream::SharedMessage made =
        stream::compress(*packed, stream::Predictor(model.vertex_count(), model.triangles));
    const std::string expected = golden(name);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(expected.data());
    const auto ours = inflate_raw({made->data() + 64, made->size() - 64}, 1000);
    const auto committed = inflate_raw({bytes + 64, expected.size() - 64}, 1000);
    REQUIRE(ours);
    REQUIRE(committed);
    CHECK(*ours == *committed);
    CHECK(std::equal(made->data(), made->data() + 56, bytes));
    CHECK(std::equal(made->data() + 60, made->data() + 64, bytes + 60));
    const auto read = decode::decode_frame({made->data(), made->size()}, model.triangles);
    REQUIRE(read);
    const std::uint8_t* vertex = packed->data() + 64;
    for (const auto& position : std::get<decode::Compressed>(read->payload).vertices) {
      CHECK(std::memcmp(position.data(), vertex, sizeof position) == 0);
      vertex += 8;
    }
  }
}

TEST_CASE(
    "the fuzz targets' decoder reads the committed bytes, no part of them, and no flip as anything but "
    "that") {
  for (const char* name :
       {"topology.bin", "frame-q16.bin", "frame-q16-asleep.bin", "frame-f32.bin", "frame-f32-diverged.bin",
        "frame-q16-speed.bin", "frame-f32-speed.bin", "frame-c16.bin", "frame-c16-speed.bin"}) {
    const std::string text = golden(name);
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    std::vector<std::array<std::uint32_t, 3>> triangles;
    if (bytes[1] == 2)
      nlohmann::json::parse(golden(std::string(name, std::strlen(name) - 3) + "json"))
          .at("triangles")
          .get_to(triangles);
    const auto same = [&](const std::vector<std::uint8_t>& given) {
      const Result<decode::Decoded> message = decode::decode_frame(given, triangles);
      if (message && message->header.encoding == 2) {
        const Result<decode::Decoded> again =
            decode::decode_frame(decode::encode_frame(*message, triangles), triangles);
        return again && std::get<decode::Compressed>(again->payload).vertices ==
                            std::get<decode::Compressed>(message->payload).vertices;
      }
      return message && decode::encode_frame(*message) == given;
    };
    INFO(name);
    REQUIRE(same(bytes));
    // Each in memory of its own size, so that AddressSanitizer sees a read behind it.
    for (auto end = bytes.begin(); end != bytes.end(); ++end)
      REQUIRE_FALSE(decode::decode_frame(std::vector<std::uint8_t>(bytes.begin(), end), triangles));
    int refused = 0;
    for (std::size_t bit = 0; bit < 8 * stream::header_bytes; ++bit) {
      std::vector<std::uint8_t> flipped = bytes;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      INFO("bit " << bit % 8 << " of byte " << bit / 8);
      if (!decode::decode_frame(flipped, triangles))
        ++refused;
      else
        REQUIRE(same(flipped));
    }
    // Vertex count and payload bytes alone.
    REQUIRE(refused >= 2 * 32);
  }
}
