#include "server/model/box_tree.h"
#include "server/base/pieces.h"

#include <algorithm>
#include <glm/common.hpp>
#include <numeric>

namespace clothlab::model {

namespace {

constexpr std::uint32_t largest_leaf = 4;

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
  return true;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Bounds>& boxes) : boxes_(boxes), order_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.push_back({{}, 0, 0, static_cast<std::uint32_t>(boxes.size())});
  Pieces pieces;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    pieces.next();
    if (nodes_[node].count > 10000) between_pieces();
    split(node);
  }
}

/// Sets the node's bounds, and halves its boxes along its longest side if they are too many for a leaf.
void BoxTree::split(std::uint32_t node) {
  const std::uint32_t first = nodes_[node].first, count = nodes_[node].count, half = count / 2;
  Bounds bounds = boxes_[order_[first]];
  for (std::uint32_t i = first; i < first + count; ++i) {
    bounds.low = glm::min(bounds.low, boxes_[order_[i]].low);
    bounds.high = glm::max(bounds.high, boxes_[order_[i]].high);
  }
  nodes_[node].bounds = bounds;
  if (count <= largest_leaf) return;
  const glm::dvec3 size = bounds.high - bounds.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = [&](std::uint32_t i) { return boxes_[i].low[axis] + boxes_[i].high[axis]; };
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count,
                   [&](std::uint32_t a, std::uint32_t b) { return middle(a) < middle(b); });
  nodes_[node].first_child = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({{}, 0, first, half});
  nodes_.push_back({{}, 0, first + half, count - half});
}

void BoxTree::overlapping(const Bounds& box, std::vector<std::uint32_t>& found) const {
  std::vector<std::uint32_t> left;
  if (!nodes_.empty()) left.push_back(0);
  while (!left.empty()) {
    const Node& node = nodes_[left.back()];
    left.pop_back();
    if (!overlap(node.bounds, box)) continue;
    if (node.first_child != 0) {
      left.push_back(node.first_child);
      left.push_back(node.first_child + 1);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (overlap(boxes_[order_[i]], box)) found.push_back(order_[i]);
  }
}

}  // namespace clothlab::model
