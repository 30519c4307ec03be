// Differences as numbers that are small where the difference is (server/net/README.md).
#pragma once

#include <cstdint>

namespace clothlab::stream {

/// The difference of two numbers modulo 65536, small ones of either sign as small numbers: 0, -1, 1, -2, ...
constexpr std::uint16_t folded(std::int32_t value, std::int32_t prediction) {
  const auto difference = static_cast<std::int16_t>(static_cast<std::uint16_t>(value - prediction));
  return static_cast<std::uint16_t>((difference << 1) ^ (difference >> 15));
}

/// The difference that `folded` wrote as `number`, in [-32768, 32767].
constexpr std::int32_t unfolded(std::uint16_t number) {
  return static_cast<std::int16_t>((number >> 1) ^ -(number & 1));
}

}  // namespace clothlab::stream
