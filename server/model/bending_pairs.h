// The stiffness between pairs of vertices, added up over a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace clothlab::model {

/// Stiffness of one pair of vertices [N/m], of either sign.
struct BendingPair {
  std::uint32_t a = 0, b = 0;  ///< a < b
  double stiffness = 0;
};

/// Takes pairs in any number and order, and holds each once.
class PairSum {
 public:
  /// `stiffness` [N/m] between two different vertices.
  void add(std::uint32_t v, std::uint32_t w, double stiffness);

  /// The pairs in rising order, without those that rounding has left of nothing.
  std::vector<BendingPair> take() &&;

 private:
  void merge();

  std::vector<BendingPair> pairs_;
  std::size_t merged_ = 0;
};

}  // namespace clothlab::model
