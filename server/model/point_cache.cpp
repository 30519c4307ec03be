#include "server/model/point_cache.h"

#include <bit>

namespace clothlab::model {

static_assert(std::endian::native == std::endian::little, "a .pc2 file has numbers as they lie in memory");

std::string point_cache_header(std::uint32_t points, std::uint32_t samples) {
  std::string header("POINTCACHE2\0", 12);
  const auto append = [&header](const auto& value) {
    header.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::int32_t{1});
  append(points);
  append(0.0f);
  append(1.0f);
  append(samples);
  return header;
}

}  // namespace clothlab::model
