// Numbers of 16 bits as planes of bytes: what compresses well lies together (server/net/README.md).
#pragma once

#include <cstddef>
#include <cstdint>

namespace clothlab::stream {

inline constexpr std::size_t axes = 3;

/// The difference of two numbers modulo 65536, small ones of either sign as small numbers: 0, -1, 1, -2, ...
constexpr std::uint16_t folded(std::int32_t value, std::int32_t prediction) {
  const auto difference = static_cast<std::int16_t>(static_cast<std::uint16_t>(value - prediction));
  return static_cast<std::uint16_t>((difference << 1) ^ (difference >> 15));
}

/// The number of which `folded` made this.
constexpr std::uint16_t unfolded(std::uint16_t fold, std::int32_t prediction) {
  return static_cast<std::uint16_t>(prediction + ((fold >> 1) ^ -(fold & 1)));
}

/// Writes a number into two planes, the low byte and the high one.
inline void put_byte_planes(std::uint16_t number, std::uint8_t& low, std::uint8_t& high) {
  low = static_cast<std::uint8_t>(number & 255);
  high = static_cast<std::uint8_t>(number >> 8);
}

}  // namespace clothlab::stream
