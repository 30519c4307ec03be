// The encodings of a frame's vertices, and all that the server's C++ knows of each. The page's decoder,
// of q16 alone, is in web/src, the layouts in server/net/README.md, the packing in shaders/stream/pack.comp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace clothlab::stream {

enum class Encoding : std::uint8_t { f32 = 0, q16 = 1, c16 = 2 };

struct EncodingFacts {
  Encoding encoding;
  const char* name;              ///< as stream.subscribe spells it
  std::size_t bytes_per_vertex;  ///< as the GPU packs it
  const char* define;            ///< the define that pack.comp is compiled with
  Encoding packed_as;            ///< an encoding whose bytes the GPU packs for this one
};

/// In the order of `Encoding`, whose numbers are sent in each header.
inline constexpr std::array encodings{
    EncodingFacts{Encoding::f32, "f32", 24, "ENCODING_F32", Encoding::f32},
    EncodingFacts{Encoding::q16, "q16", 8, "ENCODING_Q16", Encoding::q16},
    EncodingFacts{Encoding::c16, "c16", 8, "ENCODING_Q16", Encoding::q16},  // then compressed: compressor.h
};
inline constexpr std::size_t encoding_count = encodings.size();
static_assert(
    [] {
      for (std::size_t i = 0; i < encoding_count; ++i)
        if (static_cast<std::size_t>(encodings[i].encoding) != i) return false;
      return true;
    }(),
    "the rows are in the order of Encoding");

constexpr const EncodingFacts& facts(Encoding encoding) {
  return encodings[static_cast<std::size_t>(encoding)];
}

constexpr std::optional<Encoding> encoding_of(std::string_view name) {
  for (const EncodingFacts& each : encodings)
    if (each.name == name) return each.encoding;
  return std::nullopt;
}

}  // namespace clothlab::stream
