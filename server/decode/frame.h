// Reads the binary messages of the protocol strictly. It is written from the table in server/net/README.md
// alone, so that the server's messages can be checked with it. Reading loses nothing: `encode_frame` gives
// the same bytes back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/base/result.h"

namespace clothlab::decode {

struct FrameHeader {
  std::uint8_t kind = 2;      ///< 1 topology, 2 frame
  std::uint8_t encoding = 0;  ///< 0 f32, 1 q16, 2 c16
  std::uint16_t flags = 0;    ///< bit 0 asleep, bit 1 diverged
  std::uint32_t topology_revision = 0, sequence = 0, vertex_count = 0;
  double time = 0;  ///< [s]
  std::uint64_t step = 0;
  std::array<float, 3> box_minimum{}, box_extent{};  ///< [m]
  float range = 0;                                   ///< of the field; 0 without one
};

struct Topology {
  std::vector<std::array<std::uint32_t, 2>> cloths;  ///< first vertex, vertex count
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<float, 2>> texture_coordinates;  ///< [vertex_count]
};
struct Float32 {
  std::vector<std::array<float, 6>> vertices;  ///< position [m], normal
};
struct Quantised {
  struct Vertex {
    std::array<std::uint16_t, 3> position{};
    std::array<std::int8_t, 2> normal{};  ///< octahedral
    bool operator==(const Vertex&) const = default;
  };
  std::vector<Vertex> vertices;
  /// Position of a vertex: minimum + extent * u / 65535 [m].
  static std::array<double, 3> position(const FrameHeader& header, const Vertex& vertex);
};

struct Compressed {
  std::vector<std::array<std::uint16_t, 3>> vertices;  ///< positions, as Quantised has them
};

struct Decoded {
  FrameHeader header;
  std::variant<Topology, Float32, Quantised, Compressed> payload;
  std::vector<std::uint8_t> field;  ///< [vertex_count] of range / 255; empty without a field
};

inline constexpr std::size_t header_bytes = 64;

/// An error at a byte of a message.
Error refused(std::size_t offset, std::string found, std::string allowed);

using Triangles = std::span<const std::array<std::uint32_t, 3>>;

/// Reads a message, a c16 frame with the triangles of its topology. The error's `where` is "byte OFFSET".
Result<Decoded> decode_frame(std::span<const std::uint8_t> bytes, Triangles triangles = {});

/// The same bytes; of a c16 frame others may be read to the same, as there are many ways to compress.
std::vector<std::uint8_t> encode_frame(const Decoded& message, Triangles triangles = {});

}  // namespace clothlab::decode
