#include "server/cli/shard.h"

#include <charconv>
#include <system_error>

namespace clothlab::cli {

Result<Shard> shard_of(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.number);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, shard.of);
    if (second.ec == std::errc() && second.ptr == end && shard.number >= 1 && shard.number <= shard.of)
      return shard;
  }
  return Error{"--shard", "\"" + text + "\"", "i/n with 1 <= i <= n, e.g. 3/8"};
}

}  // namespace clothlab::cli
