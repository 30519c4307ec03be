#include "server/model/start.h"

namespace clothlab::model {

namespace {

/// The SplitMix64 number that follows `state` (Steele, Lea & Flood 2014). It is the same on every machine,
/// unlike the distributions of the standard library.
std::uint64_t mixed(std::uint64_t state) {
  state += 0x9e3779b97f4a7c15u;
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
  state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
  return state ^ (state >> 31);
}

/// A pseudo-random number in [-0.5, 0.5) for one coordinate of one vertex.
double spread(std::uint32_t seed, std::size_t vertex, int axis) {
  const std::uint64_t stream = mixed(seed) + 3 * vertex + static_cast<std::uint64_t>(axis);
  return static_cast<double>(mixed(stream) >> 11) * 0x1p-53 - 0.5;
}

dvec3 middle(const std::vector<dvec3>& points) {
  dvec3 sum(0.0);
  for (const dvec3& point : points) sum += point;
  return points.empty() ? sum : sum / static_cast<double>(points.size());
}

}  // namespace

std::vector<dvec3> start_positions(const scene::Start& start, const std::vector<dvec3>& rest,
                                   const std::vector<std::int32_t>& pin_motion) {
  const dvec3 centre = middle(rest);
  std::vector<dvec3> result = rest;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (pin_motion[i] != not_pinned) continue;
    if (const auto* scatter = std::get_if<scene::Scatter>(&start))
      for (int axis = 0; axis < 3; ++axis)
        result[i][axis] = centre[axis] + scatter->size * spread(scatter->seed, i, axis);
    else if (const auto* stretch = std::get_if<scene::Stretch>(&start))
      result[i] = centre + stretch->scale * (rest[i] - centre);
  }
  return result;
}

}  // namespace clothlab::model
