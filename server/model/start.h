// Where the vertices of a cloth are at time 0.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// The start of a cloth with these rest positions [m]; pinned vertices start there, whatever `start` says.
/// `pin_motion` as in Model, of the cloth's own vertices.
std::vector<dvec3> start_positions(const scene::Start& start, const std::vector<dvec3>& rest,
                                   const std::vector<std::int32_t>& pin_motion);

}  // namespace clothlab::model
