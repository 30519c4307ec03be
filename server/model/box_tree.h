// A tree of boxes along the axes, for finding those that overlap another box. It takes boxes of any sizes
// anywhere, unlike a grid of cells.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace clothlab::model {

/// A box along the axes; its faces belong to it.
struct Bounds {
  glm::dvec3 low, high;
};

class BoxTree {
 public:
  /// `boxes` must outlive the tree.
  explicit BoxTree(const std::vector<Bounds>& boxes);

  /// Appends the indices of all boxes that have a point in common with `box`, in no order that means
  /// anything.
  void overlapping(const Bounds& box, std::vector<std::uint32_t>& found) const;

 private:
  /// Children follow each other; a leaf has none, and `count` boxes.
  struct Node {
    Bounds bounds;
    std::uint32_t first_child = 0, first = 0, count = 0;
  };
  void split(std::uint32_t node);

  const std::vector<Bounds>& boxes_;
  std::vector<std::uint32_t> order_;  // the boxes' indices, those of a leaf together
  std::vector<Node> nodes_;
};

}  // namespace clothlab::model
