#include "server/stream/predictor.h"

#include <algorithm>

namespace clothlab::stream {

namespace {

struct Corner {  // a triangle seen from one of its edges
  std::uint32_t low, high, opposite;
  bool same_edge(const Corner& other) const { return low == other.low && high == other.high; }
};

std::vector<Corner> corners_by_edge(std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Corner> corners;
  corners.reserve(3 * triangles.size());
  for (const auto& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (a != b) corners.push_back({std::min(a, b), std::max(a, b), triangle[(k + 2) % 3]});
    }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.opposite < b.opposite;
  });
  return corners;
}

/// Calls `emit(rule, vertex, candidate)` for all candidates of all rules but the last.
template <class Emit>
void each_candidate(const std::vector<Corner>& corners, Emit emit) {
  for (auto at = corners.begin(); at != corners.end();) {
    const auto end =
        std::find_if(at, corners.end(), [&](const Corner& each) { return !each.same_edge(*at); });
    const std::uint32_t low = at->low, high = at->high;
    if (end - at == 2) {
      const std::uint32_t near = at[0].opposite, far = at[1].opposite;  // near <= far
      if (far < high) emit(0, high, std::array{near, far, low});
      if (high < far && near < far) emit(1, far, std::array{low, high, near});
    }
    emit(2, high, std::array{low, low, low});
    at = end;
  }
}

}  // namespace

Predictor::Predictor(std::uint32_t vertex_count, std::span<const std::array<std::uint32_t, 3>> triangles) {
  const std::vector<Corner> corners = corners_by_edge(triangles);
  constexpr int none = 3;
  std::vector<int> best(vertex_count, none);  // the first rule that has a candidate
  each_candidate(corners,
                 [&](int rule, std::uint32_t i, const Candidate&) { best[i] = std::min(best[i], rule); });
  first_.assign(vertex_count + 1, 0);
  each_candidate(corners, [&](int rule, std::uint32_t i, const Candidate&) {
    if (rule == best[i]) ++first_[i + 1];
  });
  for (std::uint32_t i = 1; i < vertex_count; ++i)
    if (best[i] == none) first_[i + 1] = 1;
  for (std::uint32_t i = 0; i < vertex_count; ++i) first_[i + 1] += first_[i];
  candidates_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  each_candidate(corners, [&](int rule, std::uint32_t i, const Candidate& candidate) {
    if (rule == best[i]) candidates_[next[i]++] = candidate;
  });
  for (std::uint32_t i = 1; i < vertex_count; ++i)
    if (best[i] == none) candidates_[next[i]] = {i - 1, i - 1, i - 1};
}

}  // namespace clothlab::stream
