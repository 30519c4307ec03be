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

}  // namespace

void write_header(const Header& header, std::uint8_t* out) {
  out = put(out, header.kind);
  out = put(out, header.encoding);
  out = put(out, header.flags);
  out = put(out, header.topology_revision);
  out = put(out, header.sequence);
  out = put(out, header.vertex_count);
  out = put(out, header.time);
  out = put(out, header.step);
  for (const glm::vec3* corner : {&header.box_minimum, &header.box_extent})
    for (int axis = 0; axis < 3; ++axis) out = put(out, (*corner)[axis]);
  out = put(out, header.payload_bytes);
  put(out, header.range);
}

std::optional<Header> read_header(const std::uint8_t* message, std::size_t size) {
  if (size < header_bytes) return std::nullopt;
  Header header;
  std::uint8_t kind = 0, encoding = 0;
  const std::uint8_t* in = get(get(message, kind), encoding);
  if (kind < static_cast<std::uint8_t>(MessageKind::topology) ||
      kind > static_cast<std::uint8_t>(MessageKind::frame) || encoding >= encoding_count)
    return std::nullopt;
  header.kind = static_cast<MessageKind>(kind);
  header.encoding = static_cast<Encoding>(encoding);
  in = get(in, header.flags);
  in = get(in, header.topology_revision);
  in = get(in, header.sequence);
  in = get(in, header.vertex_count);
  in = get(in, header.time);
  in = get(in, header.step);
  for (glm::vec3* corner : {&header.box_minimum, &header.box_extent})
    for (int axis = 0; axis < 3; ++axis) in = get(in, (*corner)[axis]);
  in = get(in, header.payload_bytes);
  get(in, header.range);
  return header.payload_bytes == size - header_bytes ? std::optional(header) : std::nullopt;
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
