// Points in cells, to find those near a place. Internal to server/mesh.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <unordered_map>
#include <vector>

namespace clothlab::mesh {

class PlaceGrid {
 public:
  /// `cell`: width of a cell [m], more than 0.
  explicit PlaceGrid(double cell) : cell_(cell) {}

  void add(std::uint32_t item, const glm::dvec3& place) { cells_[cell_of(place)].push_back(item); }

  /// Calls visit(item) for each item in the cells that the box touches, and perhaps others. Takes the number
  /// of cells and items that it looked at from `budget`; false: it was not enough.
  template <class Visit>
  bool near(const glm::dvec3& low, const glm::dvec3& high, std::size_t& budget, Visit&& visit) const {
    const Cell first = cell_of(low), last = cell_of(high);
    double count = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) count *= static_cast<double>(last[axis] - first[axis] + 1);
    if (!(count <= static_cast<double>(budget))) return false;
    budget -= static_cast<std::size_t>(count);
    for (std::int64_t x = first[0]; x <= last[0]; ++x)
      for (std::int64_t y = first[1]; y <= last[1]; ++y)
        for (std::int64_t z = first[2]; z <= last[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          if (found->second.size() > budget) return false;
          budget -= found->second.size();
          for (const std::uint32_t item : found->second) visit(item);
        }
    return true;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t at : cell)
        hash = (hash ^ static_cast<std::uint64_t>(at)) * 0x9e3779b97f4a7c15ULL, hash ^= hash >> 29;
      return static_cast<std::size_t>(hash);
    }
  };
  Cell cell_of(const glm::dvec3& place) const {
    Cell cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(place[axis] / cell_));
    return cell;
  }

  double cell_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> cells_;
};

}  // namespace clothlab::mesh
