// How fast a vibration grows from step to step when the step is longer than the method's limit. From this
// follows how many steps a trial needs before the growth shows. The recurrences are those of
// server/reference/methods.cpp for x'' + damping x' + omega^2 x = 0; their limits are in
// server/model/stability.h.
#pragma once

#include "server/model/extreme_mode.h"
#include "server/scene/scene.h"

namespace clothlab::lab {

/// The natural logarithm of the factor by which one step of `dt` [s] multiplies the vibration's amplitude; 0
/// where the amplitude does not grow.
double growth_a_step(scene::Method method, const model::Mode& mode, double dt);

/// The shortest step [s] with which the amplitude grows by a factor of e^`e_folds` within `steps` steps;
/// infinite if no step does.
double shortest_visible(scene::Method method, const model::Mode& mode, int steps, double e_folds);

}  // namespace clothlab::lab
