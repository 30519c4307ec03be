// How fast a vibration grows, step after step, under a method whose step is longer than its limit: so many
// steps does a trial need before the growth shows. The recurrences are those of server/reference/methods.cpp
// for x'' + damping x' + omega^2 x = 0, whose limits are in server/model/stability.h.
#pragma once

#include "server/model/extreme_mode.h"
#include "server/scene/scene.h"

namespace clothlab::lab {

/// Natural logarithm of the factor by which a step multiplies the amplitude; 0 where it does not grow.
double growth_a_step(scene::Method method, const model::Mode& mode, double dt);

/// The shortest step [s] whose growth multiplies the amplitude by e^`e_folds` within `steps` steps; infinite
/// if none does.
double shortest_visible(scene::Method method, const model::Mode& mode, int steps, double e_folds);

}  // namespace clothlab::lab
