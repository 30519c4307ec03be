// The positions of a cloth's vertices at time 0.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// The start positions [m] of a cloth with rest positions `rest` [m]. Pinned vertices start at their rest
/// positions, whatever `start` says. `pin_motion` is as in Model, but for this cloth's vertices only.
std::vector<dvec3> start_positions(const scene::Start& start, const std::vector<dvec3>& rest,
                                   const std::vector<std::int32_t>& pin_motion);

}  // namespace clothlab::model
