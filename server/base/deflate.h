// Raw deflate (RFC 1951), as browsers read and write it: DecompressionStream('deflate-raw').
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/base/result.h"

namespace clothlab {

/// Compresses `bytes`, behind `front` bytes of 0 that the caller fills. zlib's default effort, in blocks of
/// 4096 symbols: the kinds of bytes in a frame differ from one plane to the next.
std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes, std::size_t front = 0);

/// Decompresses exactly `size` bytes, from exactly these. Anything else is an Error, and no more memory is
/// taken than such a stream can fill.
Result<std::vector<std::uint8_t>> inflate_raw(std::span<const std::uint8_t> bytes, std::size_t size);

}  // namespace clothlab
