// The chunks of a recording, a .clothlab file (server/stream/README.md). A file may come from anywhere:
// whatever is not exactly one gives an Error.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace clothlab::film {

struct Chunk {
  std::string_view kind;     ///< four letters
  std::size_t at = 0;        ///< where it begins in the file
  std::string_view content;  ///< as it lies in the file
};

/// The chunks of `file`, whose bytes they keep pointing into.
Result<std::vector<Chunk>> chunks_of(std::string_view file);

/// What a chunk's deflate stream holds. Error: it is broken, or holds more than a recording may.
Result<std::string> inflated(const Chunk& chunk, std::string_view deflated);

/// An error at a byte of a recording.
Error damaged(std::size_t at, const std::string& what);

/// Numbers one after another.
class Numbers {
 public:
  explicit Numbers(std::string_view bytes) : bytes_(bytes) {}
  std::size_t left() const { return bytes_.size(); }
  /// The next number; 0 beyond the end, which `complete` tells.
  template <class Number>
  Number next() {
    Number number{};
    if (bytes_.size() < sizeof number) {
      complete_ = false;
      return number;
    }
    bytes_.copy(reinterpret_cast<char*>(&number), sizeof number);
    bytes_.remove_prefix(sizeof number);
    return number;
  }
  bool complete() const { return complete_; }

 private:
  std::string_view bytes_;
  bool complete_ = true;
};

}  // namespace clothlab::film
