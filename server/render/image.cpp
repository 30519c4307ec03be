#include "server/render/image.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

#include <string>

namespace clothlab::render {

Status check_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= max_image_side && height <= max_image_side) return ok();
  return Error{"size", std::to_string(width) + "x" + std::to_string(height),
               "each side from 1 to " + std::to_string(max_image_side) + " pixels"};
}

Result<std::vector<std::uint8_t>> encode_png(const Image& image) {
  std::vector<std::uint8_t> bytes;
  const auto append = [](void* to, void* data, int size) {
    const auto* first = static_cast<const std::uint8_t*>(data);
    auto* out = static_cast<std::vector<std::uint8_t>*>(to);
    out->insert(out->end(), first, first + size);
  };
  if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels, image.pixels.data(),
                              image.channels * image.width))
    return Error{"PNG", "the image could not be encoded",
                 "there may be too little memory: try a smaller size"};
  return bytes;
}

}  // namespace clothlab::render
