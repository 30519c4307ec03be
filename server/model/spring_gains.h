// What PBD and XPBD multiply a spring's stretch with when they visit it (shaders/elements/spring.glsl,
// element_projection): where stiffness in N/m and damping in N s/m become numbers for one dt.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

using elements::SpringGains;

/// 1 / (1 + dt air drag): what an implicit step makes of air drag, as if mass were more.
double mobility(const scene::Scene& scene);

/// XPBD: Macklin, Mueller & Chentanez 2016, equation 26, multiplied by stiffness dt^2, so that stiffnesses of
/// 0 and beyond all measure keep their digits. Converged, the springs' forces are those of implicit Euler.
/// PBD (Mueller et al. 2007) is XPBD without memory. Its stiffness in [0, 1] is chosen so that a spring
/// alone, after `solver.iterations` visits, is where XPBD would put it: 1 - (1 + w (dt^2 k + dt
/// c))^(-1/iterations). `inverse_mass` w [1/kg]: the sum of both ends'. Stiffness k [N/m] above 0, damping c
/// [N s/m].
SpringGains spring_gains(const scene::Solver& solver, double stiffness, double damping, double inverse_mass);

/// Of a spring's stretch the share that one visit takes away, (0, 1], for each SpringKind; none for a kind
/// that the cloth does not have.
using PbdStiffness = std::array<std::optional<double>, 3>;

/// PBD's stiffness, which is no property of the cloth alone: for each cloth what `spring_gains` makes of its
/// N/m for the scene's dt and iterations, between two free vertices of its median mass.
std::vector<PbdStiffness> pbd_stiffness(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
