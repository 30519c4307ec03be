// Provot 1995, section 4: after a step, a spring that is too long is shortened to its limit, and its ends
// move in proportion to their inverse masses; so is a triangle's warp or weft. This is repeated, because
// shortening one stretches others.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// Shortens the springs and threads of the cloths with a strain limit until none exceeds (1 + limit) rest
/// lengths by more than rounding. Adds each free vertex's correction over dt to its velocity; pinned vertices
/// stay. Returns the largest excess in the last sweep, as a share of the rest length: above 1e-12 where the
/// pins leave no way to meet the limit.
double limit_strain(const World& world, State& state);

/// The same after a step that began at `before`. Where the limit is not kept, or was not kept there, a cloth
/// takes only a share of the corrections (model::limit_shares).
double limit_strain(const World& world, const State& before, State& state);

}  // namespace clothlab::reference
