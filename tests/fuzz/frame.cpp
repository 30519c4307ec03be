// Any bytes as a binary message: they are refused with the offset of the wrong byte, or read without loss.
// The server's own code would have written the same bytes for what was read.
#include <algorithm>
#include <cstring>

#include "server/decode/frame.h"
#include "server/stream/compressor.h"
#include "server/stream/frame.h"
#include "tests/fuzz/fuzz.h"

using namespace clothlab;

namespace {

stream::Header server_header(const decode::FrameHeader& header, std::size_t payload) {
  stream::Header same;
  same.kind = static_cast<stream::MessageKind>(header.kind);
  same.encoding = static_cast<stream::Encoding>(header.encoding);
  same.flags = header.flags;
  same.topology_revision = header.topology_revision;
  same.sequence = header.sequence;
  same.vertex_count = header.vertex_count;
  same.time = header.time;
  same.step = header.step;
  for (int axis = 0; axis < 3; ++axis) {
    same.box_minimum[axis] = header.box_minimum[static_cast<std::size_t>(axis)];
    same.box_extent[axis] = header.box_extent[static_cast<std::size_t>(axis)];
  }
  same.range = header.range;
  same.payload_bytes = static_cast<std::uint32_t>(payload);
  return same;
}

model::Model server_model(const decode::FrameHeader& header, const decode::Topology& topology) {
  model::Model model;
  model.rest_position.resize(header.vertex_count);
  model.triangles = topology.triangles;
  for (const auto& [first, count] : topology.cloths) model.cloths.push_back({first, count, 0, 0, 0.0});
  for (const auto& texture : topology.texture_coordinates)
    model.texture_coordinates.emplace_back(texture[0], texture[1]);
  return model;
}

void require_in_box(const decode::FrameHeader& header, const decode::Quantised& frame) {
  for (const decode::Quantised::Vertex& vertex : frame.vertices) {
    const std::array<double, 3> place = decode::Quantised::position(header, vertex);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = static_cast<double>(header.box_minimum[axis]);
      fuzz::require(place[axis] >= low && place[axis] <= low + static_cast<double>(header.box_extent[axis]),
                    "a quantised vertex lies in the box");
    }
  }
}

using Strip = std::vector<std::array<std::uint32_t, 3>>;

/// Triangles of the first vertices of a message, so that those of c16 are predicted by lengths, too.
Strip strip_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= stream::header_bytes) std::memcpy(&count, bytes.data() + 12, sizeof count);
  Strip strip;
  for (std::uint32_t i = 0; i + 2 < std::min(count, 64u); ++i) strip.push_back({i, i + 1, i + 2});
  return strip;
}

/// The server's code compresses these vertices to what is read to them.
void require_server_writes(const decode::FrameHeader& header, const decode::Compressed& frame,
                           const std::vector<std::uint8_t>& field, const Strip& strip) {
  stream::Message packed;
  packed.header = server_header(header, 0);
  if (!field.empty()) packed.header.field = stream::Field::speed;
  packed.bytes.resize(stream::front_room + stream::header_bytes);
  for (const auto& position : frame.vertices) {
    for (const std::uint16_t axis : position) {
      packed.bytes.push_back(static_cast<std::uint8_t>(axis & 255));
      packed.bytes.push_back(static_cast<std::uint8_t>(axis >> 8));
    }
    packed.bytes.insert(packed.bytes.end(), 2, 0);
  }
  packed.bytes.insert(packed.bytes.end(), field.begin(), field.end());
  const stream::SharedMessage made = stream::compress(packed, stream::Predictor(header.vertex_count, strip));
  const Result<decode::Decoded> read = decode::decode_frame({made->data(), made->size()}, strip);
  fuzz::require(
      read && std::get<decode::Compressed>(read->payload).vertices == frame.vertices && read->field == field,
      "the server compresses the same vertices");
}

/// Reads the bytes; false if they are refused.
bool check(std::span<const std::uint8_t> bytes) {
  const Strip strip = strip_of(bytes);
  const Result<decode::Decoded> message = decode::decode_frame(bytes, strip);
  if (!message) {
    fuzz::require_complete(message.error());
    return false;
  }
  const std::vector<std::uint8_t> again = decode::encode_frame(*message, strip);
  if (const auto* compressed = std::get_if<decode::Compressed>(&message->payload)) {
    const Result<decode::Decoded> same = decode::decode_frame(again, strip);
    fuzz::require(same && std::get<decode::Compressed>(same->payload).vertices == compressed->vertices &&
                      same->field == message->field,
                  "what is compressed again is read to the same");
    require_server_writes(message->header, *compressed, message->field, strip);
  } else {
    fuzz::require(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()),
                  "what is read is written again");
  }
  std::array<std::uint8_t, stream::header_bytes> header{};
  stream::write_header(server_header(message->header, bytes.size() - header.size()), header.data());
  fuzz::require(std::equal(header.begin(), header.end(), bytes.begin()), "the server writes the same header");
  if (const auto* frame = std::get_if<decode::Quantised>(&message->payload))
    require_in_box(message->header, *frame);
  if (const auto* topology = std::get_if<decode::Topology>(&message->payload)) {
    const stream::SharedMessage same = stream::encode_topology(server_model(message->header, *topology), 1);
    fuzz::require(std::equal(same->data() + header.size(), same->data() + same->size(),
                             bytes.begin() + header.size(), bytes.end()),
                  "the server writes the same topology");
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  check(bytes);
  if (size < stream::header_bytes) return 0;
  // The same with a correct length, which a mutation seldom leaves: no part of the message is a message.
  const auto payload = static_cast<std::uint32_t>(size - stream::header_bytes);
  std::memcpy(bytes.data() + 56, &payload, sizeof payload);
  std::memset(bytes.data() + 60, 0, 4);
  if (!check(bytes)) return 0;
  for (std::size_t part = 0; part < std::min<std::size_t>(size, 256); ++part)
    fuzz::require(!check({bytes.data(), part}), "a message that ends too soon is refused");
  bytes.push_back(0);
  fuzz::require(!check(bytes), "a message with a byte too many is refused");
  return 0;
}
