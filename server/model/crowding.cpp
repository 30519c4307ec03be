#include "server/model/crowding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace clothlab::model {

namespace {

using Cell = std::array<std::int64_t, 3>;

/// `shift` 0: the grid cell that contains x [m]; -1/2: the lowest of the eight cells nearest to x.
Cell cell_of(const glm::dvec3& x, double cell, double shift) {
  Cell result;
  for (int axis = 0; axis < 3; ++axis)
    result[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::floor(std::clamp(x[axis] / cell, -1e12, 1e12) + shift));
  return result;
}

}  // namespace

double crowding(const std::vector<glm::dvec3>& positions, double cell) {
  constexpr std::size_t most_samples = 1000;
  if (positions.empty()) return 0.0;
  std::vector<Cell> cells;
  cells.reserve(positions.size());
  for (const glm::dvec3& x : positions) cells.push_back(cell_of(x, cell, 0.0));
  std::sort(cells.begin(), cells.end());
  // Golden-ratio steps sample the vertices evenly: they do not repeat with the rows of a grid.
  const double size = static_cast<double>(positions.size());
  const std::size_t samples = std::min(most_samples, positions.size());
  std::size_t candidates = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double place = 0.6180339887498949 * static_cast<double>(k);
    const auto i = static_cast<std::size_t>((place - std::floor(place)) * size);
    const Cell corner = cell_of(positions[i], cell, -0.5);
    for (int at = 0; at < 8; ++at) {
      const Cell near{corner[0] + (at & 1), corner[1] + (at >> 1 & 1), corner[2] + (at >> 2)};
      const auto [first, end] = std::equal_range(cells.begin(), cells.end(), near);
      candidates += static_cast<std::size_t>(end - first);
    }
  }
  return static_cast<double>(candidates) / static_cast<double>(samples) - 1.0;
}

}  // namespace clothlab::model
