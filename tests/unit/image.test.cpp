#include "server/render/image.h"

#include "tests/catch.h"

using namespace clothlab::render;

TEST_CASE("a picture's sides are from 1 to the largest, both bounds included") {
  CHECK(check_size(1, 1));
  CHECK(check_size(max_image_side, max_image_side));
  CHECK_FALSE(check_size(0, 10));
  CHECK_FALSE(check_size(10, -1));
  CHECK_FALSE(check_size(max_image_side + 1, 10));
}

TEST_CASE("a PNG starts with its signature and states its size") {
  const Image image{3, 2, std::vector<std::uint8_t>(18, 200)};
  const clothlab::Result<std::vector<std::uint8_t>> png = encode_png(image);
  REQUIRE(png);
  CHECK(std::vector<std::uint8_t>(png->begin(), png->begin() + 4) ==
        std::vector<std::uint8_t>{0x89, 'P', 'N', 'G'});
  CHECK((*png)[19] == 3);
  CHECK((*png)[23] == 2);
}
