// What sweeps will do to a cloth that hangs from pins, before it is stepped.
#pragma once

#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// The largest stretch at rest of the edges at the pins, as a share of their length.
struct HangingStretch {
  double by_law = 0;     ///< that of springs; 0 for finite elements, whose is not estimated
  double by_sweeps = 0;  ///< what too few sweeps add under PBD, XPBD or VBD; 0 under other methods
};

/// An estimate. The weight of a cloth, or with self-collision of all, is shared out among the edges from
/// pinned to free vertices. Each step gravity moves a vertex of mass m by g dt^2, and n sweeps must move it
/// back: a stretch C of an edge moves its ends by about C a sweep, against each other. So under a pull T an
/// edge is at rest where C is about T dt^2 / (n m), however stiff it is: measured, 1.0 to 1.25 times that
/// under XPBD, and 1.8 to 2.3 times under PBD (tests/physics/sweep_stretch.test.cpp). VBD comes to rest where
/// the law says, but stretches by as much on its way there.
HangingStretch hanging_stretch(const Model& model, const scene::Scene& scene);

/// A warning to the user if sweeps add a fifth of the length or more; empty if not.
std::string sweeps_warning(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
