// How a patch of implicit Euler's coarse level moves: as a whole, and by being stretched, sheared and turned
// about the two leading axes of its rest shape (as aggregates do in smoothed aggregation: Vanek, Mandel &
// Brezina 1996).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/model/model.h"
#include "server/sim/patch_matrix.h"

namespace clothlab::sim {

/// A vertex's share in the modes of its patch: it moves by the sum of each share times the mode's vector. 1,
/// then its places along the leading axes of the patch, in standard deviations of all from their middle; 0
/// for a mode that the patch does not have, and all 0 for a vertex that is pinned.
using Shares = std::array<double, patch_modes>;

/// For each vertex its shares. Those modes are left out of a patch that depend on others: all but the first
/// of a single vertex, the last of vertices in a row.
std::vector<Shares> shares_in_patches(const model::Model& model, const std::vector<std::uint32_t>& patch_of,
                                      std::uint32_t count);

}  // namespace clothlab::sim
