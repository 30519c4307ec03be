// Numbers that the lab compares of a state of the reference.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::lab {

/// The largest |l/L - 1| of an element.
double largest_strain(const reference::World& world, const reference::State& state);

/// The energy without the kinetic and gravitational energy of pinned vertices, as the GPU's diagnostics count
/// it.
reference::Energy energy_of_free(const reference::World& world, const reference::State& state);

}  // namespace clothlab::lab
