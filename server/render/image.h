// A picture in memory, and its encoding as PNG.
#pragma once

#include <cstdint>
#include <vector>

#include "server/base/result.h"

namespace clothlab::render {

inline constexpr int max_image_side = 4096;  ///< [pixels]

struct Image {
  int width = 0, height = 0;  ///< [pixels]
  /// sRGB-encoded RGB, or RGBA of a picture without background: [height, width, channels], top row first.
  std::vector<std::uint8_t> pixels;
  int channels = 3;
};

/// An error unless both sides are in [1, max_image_side].
Status check_size(int width, int height);

/// The image as a PNG file's bytes.
Result<std::vector<std::uint8_t>> encode_png(const Image& image);

}  // namespace clothlab::render
