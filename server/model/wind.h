// Bounds of what a scene's wind can do to its cloths. The wind's velocity at a time is in motion.h, its law
// in shaders/elements/wind.glsl.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// The largest speed of the air at any time [m/s].
double largest_wind_speed(const scene::Wind& wind);

/// The rate [1/s] at which the wind at its largest speed brakes the lightest vertex that faces it: `braking`
/// of the law over the mass. 0 without wind.
double wind_rate(const Model& model, const scene::Scene& scene);

/// The most power [W] that the wind can give to the cloths as large as they are at rest, while no part of
/// them moves through the air faster than twice the wind's largest speed W. With u the flow relative to a
/// triangle of area A and v its velocity, the force f has f.v = f.W - f.u. Drag gives density A/2 drag |u|^2
/// (W - |u|), at most 4/27 W^3 of its factors; lift, which is across the flow, gives |u|^2 W / 2, at most 2
/// W^3. 0 without wind.
double largest_wind_power(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
