#include "server/model/bending_pairs.h"

#include "server/base/pieces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clothlab::model {

void PairSum::add(std::uint32_t v, std::uint32_t w, double stiffness) {
  constexpr std::size_t most_unmerged = 1u << 22;  // 64 MiB
  if (stiffness == 0.0) return;
  const auto [a, b] = std::minmax(v, w);
  pairs_.push_back({a, b, stiffness});
  if (pairs_.size() >= 2 * merged_ + most_unmerged) merge();
}

/// Adds up the pairs that are equal, and sorts them. Equal ones are added in the order in which they came.
void PairSum::merge() {
  const auto before = [](const BendingPair& p, const BendingPair& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  };
  std::stable_sort(pairs_.begin(), pairs_.end(), before);
  between_pieces();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (kept > 0 && pairs_[kept - 1].a == pairs_[i].a && pairs_[kept - 1].b == pairs_[i].b)
      pairs_[kept - 1].stiffness += pairs_[i].stiffness;
    else
      pairs_[kept++] = pairs_[i];
  }
  pairs_.resize(kept);
  merged_ = kept;
}

std::vector<BendingPair> PairSum::take() && {
  constexpr double rounding = 1e-10;  // share of the largest stiffness
  merge();
  double largest = 0.0;
  for (const BendingPair& pair : pairs_) largest = std::max(largest, std::abs(pair.stiffness));
  std::erase_if(pairs_,
                [&](const BendingPair& pair) { return std::abs(pair.stiffness) <= rounding * largest; });
  return std::move(pairs_);
}

}  // namespace clothlab::model
