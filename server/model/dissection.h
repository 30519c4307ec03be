// An order of parts in which a matrix that couples neighbours has a factor with few entries: nested
// dissection (George 1973).
#pragma once

#include <cstdint>
#include <vector>

namespace clothlab::model {

/// A tree of groups of parts. Two parts that are neighbours lie in the same group, or the group of one is
/// above that of the other.
struct Dissection {
  struct Group {
    std::uint32_t first = 0;           ///< place of the first part of all groups below it
    std::uint32_t begin = 0, end = 0;  ///< its own places: those below it fill [first, begin)
    std::int32_t parent = -1;          ///< the group above it, or -1
  };
  std::vector<Group> groups;          ///< in the order of their places: each after those below it
  std::vector<std::uint32_t> places;  ///< [part] its place in the order
};

/// `neighbours`: for each part its neighbours, in both directions. Parts with near numbers should lie near
/// each other, as those of `patches` do.
Dissection dissect(const std::vector<std::vector<std::uint32_t>>& neighbours);

}  // namespace clothlab::model
