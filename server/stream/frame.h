// The binary messages to viewers: the 64-byte header of server/net/README.md and a payload, encoded once for
// all viewers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "server/model/model.h"
#include "server/stream/form.h"

namespace clothlab::stream {

enum class MessageKind : std::uint8_t { topology = 1, frame = 2 };
inline constexpr std::size_t header_bytes = 64;
inline constexpr std::uint16_t flag_asleep = 1, flag_diverged = 2;

struct Header {
  MessageKind kind = MessageKind::frame;
  Encoding encoding = Encoding::q16;
  Field field = Field::none;  ///< not on the wire: who subscribed knows it
  std::uint16_t flags = 0;
  std::uint32_t topology_revision = 0;
  std::uint32_t sequence = 0;
  std::uint32_t vertex_count = 0;
  double time = 0;  ///< [s]
  std::uint64_t step = 0;
  glm::vec3 box_minimum{0.0f};  ///< [m]
  glm::vec3 box_extent{0.0f};   ///< [m]
  std::uint32_t payload_bytes = 0;
  float range = 0;  ///< the field's value of a byte of 255; 0 without a field
  Form form() const { return {encoding, field}; }
};

/// Spare bytes in front of a message, as libwebsockets requires (LWS_PRE; server/net/outbox.cpp checks that).
inline constexpr std::size_t front_room = 64;

/// An encoded message: front_room spare bytes, header, payload. Immutable once shared.
struct Message {
  Header header;
  std::vector<std::uint8_t> bytes;
  /// The notification `colliders` that is sent before the frame, after front_room spare bytes. Empty: no
  /// collider moves.
  std::vector<std::uint8_t> colliders;
  std::int64_t made_at_us = 0;  ///< steady clock when its packing was requested, after its steps [us]
  const std::uint8_t* data() const { return bytes.data() + front_room; }
  std::size_t size() const { return bytes.size() - front_room; }
};
using SharedMessage = std::shared_ptr<const Message>;

/// Writes the header little-endian into `out[0, 64)`.
void write_header(const Header& header, std::uint8_t* out);

/// Reads the header of a whole message of `size` bytes. No value: it is no message of this protocol, or not
/// whole.
std::optional<Header> read_header(const std::uint8_t* message, std::size_t size);

/// The topology message: triangles, cloths, texture coordinates.
SharedMessage encode_topology(const model::Model& model, std::uint32_t revision);

}  // namespace clothlab::stream
