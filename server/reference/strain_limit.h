// Provot 1995, section 4: after a step, a spring that is too long is shortened to its limit, its ends moved
// by their inverse masses; again and again, since that stretches its neighbours.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// Shortens the springs of the cloths with a strain limit until none exceeds (1 + limit) rest lengths by more
/// than rounding; a free vertex also gets the velocity of its correction. A pinned vertex stays. Returns the
/// largest excess over (1 + limit) that is left, as a share of the rest length: above 1e-12 where the pins
/// leave no way to meet the limit.
double limit_strain(const World& world, State& state);

}  // namespace clothlab::reference
