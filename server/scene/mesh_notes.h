// In which unit a mesh seems to be. (mesh_notes() is in scene.h.)
#pragma once

#include <optional>

namespace clothlab::scene {

/// What makes metres of the unit that something of this size [in it] seems to be in: 1 from 5 cm to 10 m,
/// else one of the factors between usual units. Nothing: none makes it a usual size.
std::optional<double> unit_factor(double size);

}  // namespace clothlab::scene
