// The factors by which PBD and XPBD turn an element's stretch into pushes when they visit the element
// (element_projection in shaders/elements/), from stiffness [N/m] and damping [N s/m] for one dt.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// 1 / (1 + dt air drag), a factor on inverse masses: in an implicit step air drag acts like a larger mass.
double mobility(const scene::Scene& scene);

/// The factors of one element with stiffness k [N/m] above 0 and damping c [N s/m]. `inverse_mass` w [1/kg]
/// is the sum over its corners. XPBD: Macklin, Mueller & Chentanez 2016, equation 26, multiplied by k dt^2,
/// so that very small and very large k lose no precision. Once converged, the elements' forces are those of
/// implicit Euler. PBD (Mueller et al. 2007): XPBD without memory. Its stiffness in [0, 1] is chosen so that
/// a single element, after `solver.iterations` visits, is where XPBD would put it: 1 - (1 + w (dt^2 k + dt
/// c))^(-1/iterations).
elements::ConstraintGains constraint_gains(const scene::Solver& solver, double stiffness, double damping,
                                           double inverse_mass);
inline elements::ConstraintGains constraint_gains(const scene::Solver& solver, const elements::Spring& law,
                                                  double inverse_mass) {
  return constraint_gains(solver, law.stiffness, law.damping, inverse_mass);
}
/// For a law whose constraint is several numbers, and holds its stiffness itself: dt^2, dt, and full memory.
template <class Law>
elements::ConstraintGains constraint_gains(const scene::Solver& solver, const Law&, double) {
  return {solver.dt * solver.dt, solver.dt, 1.0, 0.0};
}

/// For each SpringKind the share of a spring's stretch that one visit removes, in (0, 1]; none for a kind
/// that the cloth does not have.
using PbdStiffness = std::array<std::optional<double>, 3>;

/// PBD's stiffness for each cloth, as `constraint_gains` derives it from the cloth's stiffness [N/m] and
/// damping for a spring between two free vertices of median mass. It also depends on the scene's dt and
/// iterations.
std::vector<PbdStiffness> pbd_stiffness(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
