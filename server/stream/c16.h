// The positions of a c16 frame as bits (server/net/README.md, "The bytes of a frame"). Each vertex is
// predicted by parallelograms, then by the lengths of its edges: cloth bends, and hardly stretches. The
// differences are Rice codes whose parameter goes by those of neighbours: Rice and Plaunt, Adaptive
// Variable-Length Coding for Efficient Compression of Spacecraft Television Data, 1971; by neighbours:
// Weinberger, Seroussi and Sapiro, The LOCO-I Lossless Image Compression Algorithm, 2000.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/stream/predictor.h"

namespace clothlab::stream {

using Position = std::array<std::uint16_t, 3>;

/// Appends the bits of `positions` [predictor.vertex_count()], in a box of this extent [m].
void put_positions(std::vector<std::uint8_t>& out, std::span<const Position> positions,
                   const std::array<float, 3>& extent, const Predictor& predictor);

}  // namespace clothlab::stream
