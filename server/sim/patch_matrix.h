// The matrix of implicit Euler's coarse level, and the inverse of its Cholesky factor. It has few entries:
// two patches are coupled only if an element has vertices of both, and in the order of a dissection
// (server/model/dissection.h) the factor and its inverse have entries only between a patch and those in
// groups above its own. The inverse of such a factor: Alvarado & Schreiber 1993.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/model/dissection.h"

namespace clothlab::sim {

/// Unknowns of a patch: three vectors, each of which scales one of its modes (coarse_modes.h).
inline constexpr std::size_t patch_modes = 3, patch_unknowns = 3 * patch_modes;

/// What one patch's unknowns do to another's, column after column [kg].
using PatchBlock = std::array<double, patch_unknowns * patch_unknowns>;

/// A symmetric matrix; patches are known by their places in a dissection.
class PatchMatrix {
 public:
  explicit PatchMatrix(model::Dissection dissection);

  const model::Dissection& dissection() const { return dissection_; }
  /// True if the matrix has room for a coupling of the two patches: they are of one group, or that of `row`
  /// is above that of `column`.
  bool couples(std::uint32_t row, std::uint32_t column) const;
  /// The block of two patches, which `couples`. Of a patch's own block, the lower triangle counts.
  PatchBlock& at(std::uint32_t row, std::uint32_t column) { return blocks_[number(row, column)]; }

  /// For each group the rows of the inverse W of the Cholesky factor, so that W^T W is the inverse of the
  /// matrix: patch_unknowns for each patch of the group, with columns from its `first` to its `end`, column
  /// after column. An unknown on which nothing depends counts as 1. Empty if the matrix is not definite or
  /// not finite.
  std::vector<std::vector<double>> inverse_factor() const;

 private:
  std::size_t number(std::uint32_t row, std::uint32_t column) const {
    return first_block_[row] + column - dissection_.groups[group_of_[row]].first;
  }

  model::Dissection dissection_;
  std::vector<std::uint32_t> group_of_;   ///< [place]
  std::vector<std::size_t> first_block_;  ///< [place]
  std::vector<PatchBlock> blocks_;  ///< place after place, those of all columns from the group's first on
};

}  // namespace clothlab::sim
