#include "server/base/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>

#include "server/base/text.h"

namespace clothlab {

namespace {

constexpr int raw = -15;  // no header or checksum, a window of 32 kB
constexpr int blocks_of_4096 = 6;
/// The most bytes that a byte of deflate can stand for.
constexpr std::size_t most_expansion = 1032;

/// zlib counts in 32 bits: a longer stretch goes in pieces.
uInt piece(std::size_t size) {
  return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
}

}  // namespace

std::vector<std::uint8_t> deflate_raw(std::span<const std::uint8_t> bytes, std::size_t front) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, raw, blocks_of_4096, Z_DEFAULT_STRATEGY) !=
      Z_OK)
    throw std::bad_alloc();
  std::vector<std::uint8_t> out(front + deflateBound(&stream, static_cast<uLong>(bytes.size())));
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.next_out = out.data() + front;
  std::size_t in_left = bytes.size(), out_left = out.size() - front;
  int state = Z_OK;
  while (state == Z_OK) {
    const uInt in = piece(in_left), room = piece(out_left);
    stream.avail_in = in;
    stream.avail_out = room;
    state = deflate(&stream, in == in_left ? Z_FINISH : Z_NO_FLUSH);
    in_left -= in - stream.avail_in;
    out_left -= room - stream.avail_out;
  }
  deflateEnd(&stream);
  out.resize(out.size() - out_left);
  return out;
}

Result<std::vector<std::uint8_t>> inflate_raw(std::span<const std::uint8_t> bytes, std::size_t size) {
  const auto refused = [&](const char* what) {
    return Error{"deflate stream", what, formatted("exactly %zu bytes, compressed", size)};
  };
  if (size / most_expansion > bytes.size()) return refused("too few bytes for what they should hold");
  z_stream stream{};
  if (inflateInit2(&stream, raw) != Z_OK) throw std::bad_alloc();
  std::vector<std::uint8_t> out(size + 1);  // a byte more, which must stay unused
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.next_out = out.data();
  std::size_t in_left = bytes.size(), out_left = out.size();
  int state = Z_OK;
  while (state == Z_OK) {
    const uInt in = piece(in_left), room = piece(out_left);
    stream.avail_in = in;
    stream.avail_out = room;
    state = inflate(&stream, Z_NO_FLUSH);
    in_left -= in - stream.avail_in;
    out_left -= room - stream.avail_out;
    if (out_left == 0) break;
  }
  inflateEnd(&stream);
  if (out_left == 0) return refused("more bytes than there should be");
  if (state != Z_STREAM_END) return refused("a stream that is broken, or ends too soon");
  if (in_left > 0) return refused("bytes after the end of the stream");
  if (out_left > 1) return refused("fewer bytes than there should be");
  out.pop_back();
  return out;
}

}  // namespace clothlab
