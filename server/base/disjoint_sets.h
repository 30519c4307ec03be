// Sets of numbers that are joined: pieces of a mesh that hang together, for example.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace clothlab {

/// The numbers 0 to count - 1, each in a set of its own until they are joined. A set is known by its smallest
/// member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }

  /// The smallest member of the set of `i`.
  std::uint32_t find(std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t one = find(a), two = find(b);
    root_[std::max(one, two)] = std::min(one, two);
  }

 private:
  std::vector<std::uint32_t> root_;  ///< a member of the same set, none larger
};

}  // namespace clothlab
