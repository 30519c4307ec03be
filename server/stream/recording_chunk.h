// The chunks of a recording (README.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/deflate.h"

namespace clothlab::stream {

/// What comes before a chunk's content, which is `head` and then `content`: kind, size and check.
inline std::string chunk_start(std::string_view kind, std::string_view head, std::string_view content) {
  std::uint32_t check = 0;
  for (const std::string_view part : {kind, head, content}) check = crc32_of(check, part);
  std::string start(kind);
  for (const std::uint32_t number : {static_cast<std::uint32_t>(head.size() + content.size()), check})
    start.append(reinterpret_cast<const char*>(&number), sizeof number);
  return start;
}

}  // namespace clothlab::stream
