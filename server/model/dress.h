// Leads the cloths that ask for it ("start": {"dress": seconds}) out of bodies and of cloth, before time 0.
//
// A step moves each vertex by at most a quarter of the mean edge. In it the lengths of the start are kept as
// well as can be (Muller et al. 2007, "Position based dynamics"), and these hold instead where both do not
// fit:
// - a vertex in a body goes out by the shortest way; one that is nearer than contact keeps it goes away
// (skin.h)
// - cloth through cloth goes back by the way that undoes it (untangle.h)
// Once nothing crosses, what is left of the steps draws lengths together, and a vertex that would cross stays
// where it is. All in double precision, with what crosses judged exactly at the positions that the GPU gets
// (crossings.h).
#pragma once

#include <string>

#include "server/model/model.h"

namespace clothlab::model {

/// Steps in a second of leading out.
inline constexpr double dress_steps_per_second = 500.0;

/// Gives `model`, which has its cloths and bodies, the start positions of cloths that are led out, and says
/// in `model.dressed` what was done. Where it does not succeed within the time, the positions reached stay:
/// check_start refuses what crosses, and dressed_note tells of cloth that is still in a solid. The same scene
/// gives the same places; those found last are remembered.
void dress(Model& model, const scene::Scene& scene);

/// What to tell a person of cloth that asks to be led out; empty if none does.
std::string dressed_note(const Model& model);

}  // namespace clothlab::model
