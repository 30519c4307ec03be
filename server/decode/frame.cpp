#include "server/decode/frame.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "server/base/deflate.h"
#include "server/decode/c16.h"

namespace clothlab::decode {

Error refused(std::size_t offset, std::string found, std::string allowed) {
  return {"byte " + std::to_string(offset), std::move(found), std::move(allowed)};
}

namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

template <class T>
T number_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.subspan(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

/// `count` items, one after another; the caller has checked that the bytes hold them.
template <class T>
std::vector<T> items_at(std::span<const std::uint8_t> bytes, std::size_t& offset, std::size_t count) {
  std::vector<T> items(count);
  const std::span<const std::uint8_t> there = bytes.subspan(offset, count * sizeof(T));
  if (!there.empty()) std::memcpy(items.data(), there.data(), there.size());
  offset += there.size();
  return items;
}

Result<FrameHeader> read_header(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < header_bytes)
    return refused(0, std::to_string(bytes.size()) + " bytes", "a header of 64");
  FrameHeader header;
  header.kind = bytes[0];
  header.encoding = bytes[1];
  header.flags = number_at<std::uint16_t>(bytes, 2);
  header.topology_revision = number_at<std::uint32_t>(bytes, 4);
  header.sequence = number_at<std::uint32_t>(bytes, 8);
  header.vertex_count = number_at<std::uint32_t>(bytes, 12);
  header.time = number_at<double>(bytes, 16);
  header.step = number_at<std::uint64_t>(bytes, 24);
  header.box_minimum = number_at<std::array<float, 3>>(bytes, 32);
  header.box_extent = number_at<std::array<float, 3>>(bytes, 44);
  if (header.kind != 1 && header.kind != 2)
    return refused(0, "kind " + std::to_string(header.kind), "1 or 2");
  if (header.encoding > (header.kind == 1 ? 1 : 2))
    return refused(1, "encoding " + std::to_string(header.encoding), "0 (f32), 1 (q16) or 2 (c16)");
  if (header.flags > 3) return refused(2, "flags " + std::to_string(header.flags), "bits 0 and 1");
  if (!(header.time >= 0.0 && std::isfinite(header.time)))
    return refused(16, "a time that is none", "0 s or later");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(header.box_minimum[axis])) return refused(32 + 4 * axis, "no number", "a finite one");
    if (!(header.box_extent[axis] >= 0.0f && std::isfinite(header.box_extent[axis])))
      return refused(44 + 4 * axis, "an extent that is none", "0 m or more");
  }
  const std::size_t payload = number_at<std::uint32_t>(bytes, 56);
  if (payload != bytes.size() - header_bytes)
    return refused(56, std::to_string(payload) + " payload bytes",
                   std::to_string(bytes.size() - header_bytes) + ", as many as there are");
  header.range = number_at<float>(bytes, 60);
  const bool none = number_at<std::uint32_t>(bytes, 60) == 0;
  if (!none && header.kind == 1) return refused(60, "a number", "0");
  if (!none && !(header.range > 0.0f && std::isfinite(header.range)))
    return refused(60, "a range that is none", "0 bits, or above 0");
  return header;
}

Result<Topology> read_topology(std::span<const std::uint8_t> bytes, const FrameHeader& header) {
  std::size_t offset = header_bytes;
  if (bytes.size() < offset + 8)
    return refused(offset, "a payload too short for its counts", "8 bytes or more");
  const std::uint64_t triangles = number_at<std::uint32_t>(bytes, offset),
                      cloths = number_at<std::uint32_t>(bytes, offset + 4);
  offset += 8;
  // In 64 bits: three 32-bit counts cannot overflow that.
  if (8 * cloths + 12 * triangles + 8 * std::uint64_t{header.vertex_count} != bytes.size() - offset)
    return refused(offset, std::to_string(bytes.size() - offset) + " bytes after the counts",
                   "as many as they say");
  Topology topology;
  topology.cloths = items_at<std::array<std::uint32_t, 2>>(bytes, offset, cloths);
  topology.triangles = items_at<std::array<std::uint32_t, 3>>(bytes, offset, triangles);
  topology.texture_coordinates = items_at<std::array<float, 2>>(bytes, offset, header.vertex_count);
  std::uint64_t next = 0;
  for (const auto& [first, count] : topology.cloths) {
    if (first != next)
      return refused(header_bytes + 8, "a cloth that starts elsewhere", "where the one before ends");
    next += count;
  }
  if (next != header.vertex_count)
    return refused(header_bytes + 8, std::to_string(next) + " vertices in all cloths", "those of the header");
  for (const auto& triangle : topology.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= header.vertex_count)
        return refused(header_bytes + 8 + 8 * cloths, "vertex " + std::to_string(corner),
                       "one below the vertex count");
  for (const auto& texture : topology.texture_coordinates)
    if (!std::isfinite(texture[0]) || !std::isfinite(texture[1]))
      return refused(header_bytes + 8 + 8 * cloths + 12 * triangles, "no number", "texture coordinates");
  return topology;
}

template <class Vertex>
Result<std::vector<Vertex>> read_vertices(std::span<const std::uint8_t> bytes, const FrameHeader& header) {
  std::size_t offset = header_bytes;
  const std::size_t each = sizeof(Vertex) + (header.range > 0.0f ? 1 : 0);
  if (std::uint64_t{header.vertex_count} * each != bytes.size() - offset)
    return refused(12, std::to_string(header.vertex_count) + " vertices",
                   std::to_string(each) + " bytes of payload for each");
  return items_at<Vertex>(bytes, offset, header.vertex_count);
}

/// What follows all vertices.
std::vector<std::uint8_t> read_field(std::span<const std::uint8_t> bytes, const FrameHeader& header) {
  const auto field = bytes.last(header.range > 0.0f ? header.vertex_count : 0);
  return {field.begin(), field.end()};
}

template <class T>
void put(std::vector<std::uint8_t>& out, const T& value) {
  out.resize(out.size() + sizeof value);
  std::memcpy(out.data() + out.size() - sizeof value, &value, sizeof value);
}

template <class Items>
void put_all(std::vector<std::uint8_t>& out, const Items& items) {
  for (const auto& item : items) put(out, item);
}

}  // namespace

std::array<double, 3> Quantised::position(const FrameHeader& header, const Vertex& vertex) {
  std::array<double, 3> place{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    place[axis] = static_cast<double>(header.box_minimum[axis]) +
                  static_cast<double>(header.box_extent[axis]) * vertex.position[axis] / 65535.0;
  return place;
}

Result<Decoded> decode_frame(std::span<const std::uint8_t> bytes, Triangles triangles) {
  const Result<FrameHeader> header = read_header(bytes);
  if (!header) return header.error();
  if (header->kind == 1) {
    Result<Topology> topology = read_topology(bytes, *header);
    if (!topology) return topology.error();
    return Decoded{*header, std::move(*topology), {}};
  }
  if (header->encoding == 2) return read_compressed(bytes, *header, triangles);
  if (header->encoding == 1) {
    static_assert(sizeof(Quantised::Vertex) == 8);
    auto vertices = read_vertices<Quantised::Vertex>(bytes, *header);
    if (!vertices) return vertices.error();
    return Decoded{*header, Quantised{std::move(*vertices)}, read_field(bytes, *header)};
  }
  auto vertices = read_vertices<std::array<float, 6>>(bytes, *header);
  if (!vertices) return vertices.error();
  for (std::size_t i = 0; i < vertices->size(); ++i)
    for (const float number : (*vertices)[i])
      if (!std::isfinite(number)) return refused(header_bytes + 24 * i, "no number", "positions and normals");
  return Decoded{*header, Float32{std::move(*vertices)}, read_field(bytes, *header)};
}

std::vector<std::uint8_t> encode_frame(const Decoded& message, Triangles triangles) {
  std::vector<std::uint8_t> payload;
  if (const auto* topology = std::get_if<Topology>(&message.payload)) {
    put(payload, static_cast<std::uint32_t>(topology->triangles.size()));
    put(payload, static_cast<std::uint32_t>(topology->cloths.size()));
    put_all(payload, topology->cloths);
    put_all(payload, topology->triangles);
    put_all(payload, topology->texture_coordinates);
  } else if (const auto* quantised = std::get_if<Quantised>(&message.payload)) {
    put_all(payload, quantised->vertices);
  } else if (const auto* compressed = std::get_if<Compressed>(&message.payload)) {
    std::vector<std::uint8_t> content = message.field;
    put_compressed(content, message.header, *compressed, triangles);
    payload = deflate_raw(content);
  } else {
    put_all(payload, std::get<Float32>(message.payload).vertices);
  }
  if (!std::holds_alternative<Compressed>(message.payload)) put_all(payload, message.field);
  const FrameHeader& header = message.header;
  std::vector<std::uint8_t> out{header.kind, header.encoding};
  put(out, header.flags);
  put(out, header.topology_revision);
  put(out, header.sequence);
  put(out, header.vertex_count);
  put(out, header.time);
  put(out, header.step);
  put(out, header.box_minimum);
  put(out, header.box_extent);
  put(out, static_cast<std::uint32_t>(payload.size()));
  put(out, header.range);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

}  // namespace clothlab::decode
