#include "server/render/image.h"

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb_image.h>

#include <memory>

#include "tests/catch.h"

using namespace clothlab::render;

TEST_CASE("a picture's sides are from 1 to the largest, both bounds included") {
  CHECK(check_size(1, 1));
  CHECK(check_size(max_image_side, max_image_side));
  CHECK_FALSE(check_size(0, 10));
  CHECK_FALSE(check_size(10, -1));
  CHECK_FALSE(check_size(max_image_side + 1, 10));
}

TEST_CASE("a PNG has the pixels that it was made of, row by row from the top") {
  Image image{3, 2, {}};
  for (int i = 0; i < 18; ++i) image.pixels.push_back(static_cast<std::uint8_t>(13 * i));
  const clothlab::Result<std::vector<std::uint8_t>> png = encode_png(image);
  REQUIRE(png);
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(png->data(), static_cast<int>(png->size()), &width, &height, &channels, 0),
      &stbi_image_free);
  REQUIRE(pixels);
  CHECK(width == 3);
  CHECK(height == 2);
  REQUIRE(channels == 3);
  CHECK(std::vector<std::uint8_t>(pixels.get(), pixels.get() + 18) == image.pixels);
}
