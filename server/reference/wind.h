// The wind in the reference: the load on each vertex, triangle by triangle.
#pragma once

#include "server/reference/reference.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

/// A third of each adjacent triangle's load, for each vertex, in the wind at time t [s]. Zeros without wind.
std::vector<elements::WindLoad> wind_loads(const World& world, const std::vector<dvec3>& position,
                                           const std::vector<dvec3>& velocity, double t);

/// Adds the acceleration that an explicit step of dt gives each vertex [m/s^2].
void add_wind(const World& world, const std::vector<dvec3>& position, const std::vector<dvec3>& velocity,
              double t, std::vector<dvec3>& acceleration);

}  // namespace clothlab::reference
