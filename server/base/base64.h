// Bytes as text in base64 (RFC 4648, padded), and back.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace clothlab {

std::string to_base64(std::span<const std::byte> bytes);

/// The numbers as they lie in memory, little-endian.
template <class Number>
std::string to_base64(const std::vector<Number>& numbers) {
  return to_base64(std::as_bytes(std::span(numbers)));
}

/// The bytes of a text, or nothing if it is no base64.
std::optional<std::string> from_base64(const std::string& text);

}  // namespace clothlab
