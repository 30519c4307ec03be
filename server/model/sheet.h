// Finite elements of a cloth: a membrane for each triangle, and what bends. Internal to model/.
#pragma once

#include <vector>

#include "server/model/model.h"
#include "server/model/plate.h"

namespace clothlab::model {

/// The axes of a mesh's texture, in space; of length 1.
struct TextureAxes {
  dvec3 first, second;
};

/// The flat pattern of a cloth, or null: its rest shape is that of its vertices.
const std::vector<FlatTriangle>* pattern_of(const scene::Cloth& cloth);

/// Appends the finite elements of `cloth`, which is the model's last; those that only sweeps visit if
/// `sweeps_elements`. An error if a triangle has no area.
Status add_sheet(Model& model, const scene::Cloth& cloth, const TextureAxes& axes, bool sweeps_elements);

}  // namespace clothlab::model
