// Warns of a start in which surfaces are so near to each other that contact between them has no room to work.
#pragma once

#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// What to tell a person if triangles or edges start nearer to each other than rounding in 32-bit floats lets
/// the filter of surface contact tell apart (shaders/surface/limit.comp): it then holds them where they are,
/// pins too. Names the nearest pair, the gap that is needed there, and what helps. Empty if there is none, or
/// if the scene has no contact between surfaces.
std::string near_start_warning(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
