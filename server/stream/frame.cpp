#include "server/stream/frame.h"

#include <bit>
#include <cstring>

namespace clothlab::stream {

namespace {

static_assert(std::endian::native == std::endian::little,
              "the wire format is little-endian, and so must the machine be");

template <class T>
std::uint8_t* put(std::uint8_t* out, const T& value) {
  std::memcpy(out, &value, sizeof(T));
  return out + sizeof(T);
}

template <class T>
const std::uint8_t* get(const std::uint8_t* in, T& value) {
  std::memcpy(&value, in, sizeof(T));
  return in + sizeof(T);
}

/// Calls `use` with each field of a header, in the order in which they are sent.
template <class AnyHeader, class Use>
void for_each_field(AnyHeader& header, const Use& use) {
  use(header.kind);
  use(header.encoding);
  use(header.flags);
  use(header.topology_revision);
  use(header.sequence);
  use(header.vertex_count);
  use(header.time);
  use(header.step);
  for (auto* corner : {&header.box_minimum, &header.box_extent})
    for (int axis = 0; axis < 3; ++axis) use((*corner)[axis]);
  use(header.payload_bytes);
  use(header.range);
}

}  // namespace

void write_header(const Header& header, std::uint8_t* out) {
  for_each_field(header, [&](const auto& field) { out = put(out, field); });
}

std::optional<Header> read_header(const std::uint8_t* message, std::size_t size) {
  if (size < header_bytes) return std::nullopt;
  Header header;
  for_each_field(header, [&](auto& field) { message = get(message, field); });
  const bool known = (header.kind == MessageKind::topology || header.kind == MessageKind::frame) &&
                     static_cast<std::size_t>(header.encoding) < encoding_count;
  return known && header.payload_bytes == size - header_bytes ? std::optional(header) : std::nullopt;
}

SharedMessage encode_topology(const model::Model& model, std::uint32_t revision) {
  auto message = std::make_shared<Message>();
  Header& header = message->header;
  header.kind = MessageKind::topology;
  header.encoding = Encoding::f32;
  header.topology_revision = revision;
  header.vertex_count = model.vertex_count();
  header.payload_bytes = static_cast<std::uint32_t>(
      8 + 8 * model.cloths.size() + 12 * model.triangles.size() + 8 * model.texture_coordinates.size());
  message->bytes.resize(front_room + header_bytes + header.payload_bytes);
  std::uint8_t* out = message->bytes.data() + front_room;
  write_header(header, out);
  out = put(out + header_bytes, model.triangle_count());
  out = put(out, static_cast<std::uint32_t>(model.cloths.size()));
  for (const model::ClothRange& cloth : model.cloths)
    out = put(put(out, cloth.first_vertex), cloth.vertex_count);
  for (const auto& triangle : model.triangles) out = put(out, triangle);
  for (const glm::vec2& texture : model.texture_coordinates) out = put(put(out, texture.x), texture.y);
  return message;
}

}  // namespace clothlab::stream
