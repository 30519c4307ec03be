// Divides the vertices into patches: compact sets of nearly equal size.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// For each vertex the number of its patch, below `count` (1 or more; at most the number of vertices, which
/// must not be 0). No patch is empty. Cloths are kept apart as far as `count` allows; within a cloth the
/// longest extent of the rest shape is halved again and again (recursive coordinate bisection: Berger &
/// Bokhari 1987).
std::vector<std::uint32_t> patches(const Model& model, std::uint32_t count);

}  // namespace clothlab::model
