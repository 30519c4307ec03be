// Compression by libdeflate, of whole stretches of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace clothlab {

/// Raw deflate (RFC 1951), as browsers read and write it (DecompressionStream('deflate-raw')), behind `front`
/// bytes of 0 that the caller fills. With the usual effort, level 6.
std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes, std::size_t front = 0);

/// Decompresses `most` bytes at most, from exactly these. Anything else is an Error, and no more memory is
/// taken than such a stream can fill.
Result<std::vector<std::uint8_t>> inflate_raw(std::span<const std::uint8_t> bytes, std::size_t most);

/// A gzip file (RFC 1952) of `bytes`, with great effort, level 9: each server packs its page at its start.
std::string gzip(std::string_view bytes);

/// The CRC-32 of gzip and PNG over what came before, whose CRC is `before` (at first 0), and `bytes`.
std::uint32_t crc32_of(std::uint32_t before, std::string_view bytes);

}  // namespace clothlab
