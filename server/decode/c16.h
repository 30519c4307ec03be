// Reads and writes the payload of a c16 frame by the rules in server/net/README.md, for frame.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/decode/frame.h"

namespace clothlab::decode {

/// Reads a frame with this header, `bytes` with its 64 bytes. Error: what of it is no such frame.
Result<Decoded> read_compressed(std::span<const std::uint8_t> bytes, const FrameHeader& header,
                                Triangles triangles);

/// Appends the bits of the positions to `out`, which has the field's bytes: what is then deflated.
void put_compressed(std::vector<std::uint8_t>& out, const FrameHeader& header, Compressed frame,
                    Triangles triangles);

}  // namespace clothlab::decode
