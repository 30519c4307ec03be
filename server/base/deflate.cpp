#include "server/base/deflate.h"

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>

#include "server/base/text.h"

namespace clothlab {

namespace {

/// The most bytes that a byte of deflate can stand for.
constexpr std::size_t most_expansion = 1032;

struct Free {
  void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
  void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};
using Compressor = std::unique_ptr<libdeflate_compressor, Free>;

Compressor compressor_of(int level) {
  Compressor made(libdeflate_alloc_compressor(level));
  if (!made) throw std::bad_alloc();
  return made;
}

}  // namespace

std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes, std::size_t front) {
  static thread_local const Compressor compressor = compressor_of(6);  // its tables are large
  std::vector<std::uint8_t> out(front + libdeflate_deflate_compress_bound(compressor.get(), bytes.size()));
  out.resize(front + libdeflate_deflate_compress(compressor.get(), bytes.data(), bytes.size(),
                                                 out.data() + front, out.size() - front));
  return out;
}

Result<std::vector<std::uint8_t>> inflate_raw(std::span<const std::uint8_t> bytes, std::size_t most) {
  const auto refused = [&](const char* what) {
    return Error{"deflate stream", what, formatted("at most %zu bytes, compressed", most)};
  };
  const std::unique_ptr<libdeflate_decompressor, Free> decompressor(libdeflate_alloc_decompressor());
  if (!decompressor) throw std::bad_alloc();
  std::vector<std::uint8_t> out(std::min(most, most_expansion * bytes.size()));
  std::size_t read = 0, written = 0;
  switch (libdeflate_deflate_decompress_ex(decompressor.get(), bytes.data(), bytes.size(), out.data(),
                                           out.size(), &read, &written)) {
    case LIBDEFLATE_SUCCESS:
      break;
    case LIBDEFLATE_INSUFFICIENT_SPACE:
      return refused("more bytes than there may be");
    default:
      return refused("a stream that is broken, or ends too soon");
  }
  if (read < bytes.size()) return refused("bytes after the end of the stream");
  out.resize(written);
  return out;
}

std::string gzip(std::string_view bytes) {
  const Compressor compressor = compressor_of(9);
  std::string out(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()), '\0');
  out.resize(libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

std::uint32_t crc32_of(std::uint32_t before, std::string_view bytes) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

}  // namespace clothlab
