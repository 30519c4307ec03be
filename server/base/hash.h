// A hash of texts, by which results are found again.
#pragma once

#include <cstdint>
#include <string>

namespace clothlab {

/// A hash of 128 bits from two lanes of 64 bits: FNV-1a, and a variant of it. It does not withstand an
/// attacker, who would gain nothing from a collision.
class Hash {
 public:
  /// Adds a text and its length, so that "ab", "c" and "a", "bc" give different hashes.
  void add(const std::string& bytes);
  /// 32 hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t first_ = 0xcbf29ce484222325ull, second_ = 0x84222325cbf29ce4ull;
};

}  // namespace clothlab
