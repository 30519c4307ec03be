// PBD (Mueller et al. 2007), XPBD (Macklin, Mueller & Chentanez 2016) and VBD (Chen et al. 2024) in double
// precision: Gauss-Seidel sweeps over the springs or over the vertices, colour by colour, find the
// displacement of a step. Contacts are treated within the iterations, not after them.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// A whole step from time t to t_next = t + solver.dt, with contacts, pins and strain limit, by the scene's
/// method, for which scene::sweeps must be true. Always makes exactly `solver.iterations` sweeps.
void gauss_seidel_step(const World& world, State& state, double t, double t_next);

}  // namespace clothlab::reference
