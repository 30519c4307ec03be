// Predicts each vertex of a frame from vertices with lower numbers, by parallelograms of triangles: Touma and
// Gotsman, Triangle Mesh Compression, 1998; several at a vertex: Isenburg and Alliez, Compressing Polygon
// Mesh Geometry with Parallelogram Prediction, 2002. The rules are in server/net/README.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace clothlab::stream {

class Predictor {
 public:
  Predictor() = default;
  Predictor(std::uint32_t vertex_count, std::span<const std::array<std::uint32_t, 3>> triangles);

  using Candidate = std::array<std::uint32_t, 3>;  ///< a, b, c stand for a + b - c

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(first_.size() - 1); }

  /// Of vertex i. Without a parallelogram it is one vertex three times, for vertex 0 itself.
  Candidate first_candidate(std::uint32_t i) const {
    return first_[i] < first_[i + 1] ? candidates_[first_[i]] : Candidate{i, i, i};
  }

  /// The prediction for vertex i of `values` [vertex_count, stride], of which `axis` is read: the mean of its
  /// candidates, rounded down. Reads vertices below i only.
  template <class Value>
  std::int32_t at(std::uint32_t i, const Value* values, std::size_t stride, std::size_t axis) const {
    const std::uint32_t first = first_[i], end = first_[i + 1];
    if (first == end) return 0;
    const auto value = [&](std::uint32_t vertex) { return std::int64_t{values[vertex * stride + axis]}; };
    std::int64_t sum = 0;
    for (std::uint32_t k = first; k < end; ++k)
      sum += value(candidates_[k][0]) + value(candidates_[k][1]) - value(candidates_[k][2]);
    const std::int64_t count = end - first;
    return static_cast<std::int32_t>(sum >= 0 ? sum / count : -((count - 1 - sum) / count));
  }

 private:
  std::vector<std::uint32_t> first_{0};  ///< [vertex_count + 1] into `candidates_`
  std::vector<Candidate> candidates_;
};

}  // namespace clothlab::stream
