// The encoding c16 loses nothing, for any triangles: what the server compresses, the decoder that was written
// from server/net/README.md reads to the same numbers.
#include <random>

#include "server/base/deflate.h"
#include "server/decode/frame.h"
#include "server/stream/compressor.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

using Positions = std::vector<std::array<std::uint16_t, 3>>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// As Packer makes a frame for c16.
stream::Message packed(const Positions& positions, const std::vector<std::uint8_t>& field) {
  stream::Message message;
  message.header.encoding = stream::Encoding::c16;
  message.header.vertex_count = static_cast<std::uint32_t>(positions.size());
  message.header.field = field.empty() ? stream::Field::none : stream::Field::strain;
  message.header.range = field.empty() ? 0.0f : 0.5f;
  message.bytes.resize(stream::front_room + stream::header_bytes);
  for (const auto& position : positions) {
    for (const std::uint16_t number : position)
      for (const int byte : {number & 255, number >> 8})
        message.bytes.push_back(static_cast<std::uint8_t>(byte));
    message.bytes.insert(message.bytes.end(), {7, 9});  // the normal, which is not sent
  }
  message.bytes.insert(message.bytes.end(), field.begin(), field.end());
  return message;
}

}  // namespace

TEST_CASE(
    "what is deflated is read to the same, and a part of it, more than it, or too large a content is "
    "refused") {
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes(5000);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() % 7);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, bytes.size()}) {
    const std::span<const std::uint8_t> some(bytes.data(), size);
    std::vector<std::uint8_t> stream = deflate_raw(some);
    const auto read = inflate_raw(stream, size);
    REQUIRE(read);
    CHECK(std::equal(read->begin(), read->end(), some.begin(), some.end()));
    for (std::size_t part = 0; part < stream.size(); ++part)
      CHECK_FALSE(inflate_raw({stream.data(), part}, size));
    const auto with_room = inflate_raw(stream, std::size_t{1} << 60);
    REQUIRE(with_room);
    CHECK(*with_room == *read);
    if (size > 0) CHECK_FALSE(inflate_raw(stream, size - 1));
    stream.push_back(0);
    CHECK_FALSE(inflate_raw(stream, size));
  }
}

TEST_CASE("c16 is read to the same positions and field, whatever the triangles are like") {
  std::mt19937 random(2);
  for (int round = 0; round < 200; ++round) {
    INFO("round " << round);
    Positions positions(random() % 30);
    for (auto& position : positions)
      for (std::uint16_t& number : position)
        number = static_cast<std::uint16_t>(round % 2 == 0 ? random() : 65535 * (random() % 2));
    // Also with corners twice, triangles twice, and edges of three triangles.
    Triangles triangles(positions.empty() ? 0 : random() % 60);
    for (auto& triangle : triangles)
      for (std::uint32_t& corner : triangle) corner = static_cast<std::uint32_t>(random() % positions.size());
    std::vector<std::uint8_t> field(round % 3 == 0 ? positions.size() : 0);
    for (std::uint8_t& byte : field) byte = static_cast<std::uint8_t>(random());

    stream::Message frame = packed(positions, field);
    constexpr std::array usual{0.7f, 1.3f, 2.0f}, odd{0.0f, 1e-45f, 3e38f};  // [m]
    for (int axis = 0; axis < 3; ++axis)
      frame.header.box_extent[axis] = (random() % 8 == 0 ? odd : usual)[random() % 3];

    const stream::Predictor predictor(static_cast<std::uint32_t>(positions.size()), triangles);
    const stream::SharedMessage made = stream::compress(frame, predictor);
    const auto read = decode::decode_frame({made->data(), made->size()}, triangles);
    REQUIRE(read);
    CHECK(std::get<decode::Compressed>(read->payload).vertices == positions);
    CHECK(read->field == field);
  }
}

TEST_CASE(
    "the thread that compresses gives every frame back, in their order, and says when there is no room") {
  stream::Compressor compressor;
  model::Model model;
  model.rest_position.resize(3);
  model.triangles = {{0, 1, 2}};
  compressor.set_mesh(model, 1);
  CHECK_FALSE(compressor.busy());
  std::uint32_t offered = 0, taken = 0;
  const auto take = [&] {
    while (const stream::SharedMessage frame = compressor.poll()) CHECK(frame->header.sequence == ++taken);
  };
  while (offered < 200) {
    if (!compressor.full()) {
      stream::Message message = packed({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {});
      message.header.sequence = ++offered;
      compressor.offer(std::make_shared<const stream::Message>(std::move(message)));
      CHECK(compressor.busy());
    }
    take();
  }
  while (compressor.busy()) take();
  CHECK(taken == 200);
}
