// PC2 files (point cache 2), which Blender and others read: places of a mesh's vertices, one sample after the
// other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace clothlab::model {

inline constexpr std::size_t point_cache_header_bytes = 32;

/// The header: "POINTCACHE2\0", version (1), points, first frame, frames per sample, samples; little-endian.
/// After it each sample has a place [m] a point, of three floats.
std::string point_cache_header(std::uint32_t points, std::uint32_t samples);

}  // namespace clothlab::model
