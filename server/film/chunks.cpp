#include "server/film/chunks.h"

#include <algorithm>
#include <cstdint>
#include <span>

#include "server/base/deflate.h"

namespace clothlab::film {

namespace {

constexpr std::string_view magic = "CLOTHLAB";
constexpr std::uint32_t version = 1;
constexpr std::size_t kind_bytes = 4;
/// No chunk holds more: a group has at most 2^21 vertices of 6 bytes, a mesh or a body what a scene may have.
constexpr std::size_t most_inflated = std::size_t{1} << 30;
constexpr const char* get_it_again = "copy or download it again";

}  // namespace

Error damaged(std::size_t at, const std::string& what) {
  return {"byte " + std::to_string(at) + " of the recording", what, get_it_again};
}

Result<std::vector<Chunk>> chunks_of(std::string_view file) {
  Numbers head(file.substr(std::min(file.size(), magic.size())));
  const auto found = head.next<std::uint32_t>();
  const auto zero = head.next<std::uint32_t>();
  if (!file.starts_with(magic) || !head.complete())
    return damaged(0, "this is no recording, which begins with " + std::string(magic));
  if (found != version)
    return Error{"recording", "its version is " + std::to_string(found),
                 "version 1, which this program writes; take a newer program"};
  if (zero != 0) return damaged(magic.size() + 4, "a number that is not 0");
  std::vector<Chunk> chunks;
  for (std::size_t at = file.size() - head.left(); at < file.size();) {
    const std::string_view kind = file.substr(at, kind_bytes);
    Numbers numbers(file.substr(std::min(file.size(), at + kind_bytes)));
    const auto size = numbers.next<std::uint32_t>();
    const auto check = numbers.next<std::uint32_t>();
    if (!numbers.complete() || numbers.left() < size) return damaged(file.size(), "it is cut off here");
    if (!std::all_of(kind.begin(), kind.end(), [](char letter) { return letter >= 'a' && letter <= 'z'; }))
      return damaged(at, "a chunk without a name");
    const std::string_view content = file.substr(file.size() - numbers.left(), size);
    if (crc32_of(crc32_of(0, kind), content) != check)
      return damaged(at, "the check of the chunk " + std::string(kind) + " does not fit its bytes");
    chunks.push_back({kind, at, content});
    at = file.size() - numbers.left() + size;
  }
  return chunks;
}

Result<std::string> inflated(const Chunk& chunk, std::string_view deflated) {
  const Result<std::vector<std::uint8_t>> bytes =
      inflate_raw({reinterpret_cast<const std::uint8_t*>(deflated.data()), deflated.size()}, most_inflated);
  if (!bytes) return damaged(chunk.at, "in the chunk " + std::string(chunk.kind) + " " + bytes.error().what);
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace clothlab::film
