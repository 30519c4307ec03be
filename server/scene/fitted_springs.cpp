#include "server/scene/fitted_springs.h"

#include <algorithm>
#include <cmath>

namespace clothlab::scene {

namespace {

constexpr double gravity = 9.8;  ///< [m/s^2]; not the scene's, so that no fabric changes with it

/// Stiffness [N/m] of the springs to the second neighbours. Where the sheet turns by an angle at each vertex,
/// such a spring is 2 spacing (1 - cos(angle / 2)) shorter, and there is one a direction for each
/// spacing^2.
double bend_of(const Fem& sheet, double spacing, double area_density) {
  const double bending = std::sqrt(sheet.bending.warp * sheet.bending.weft);
  if (!(bending > 0.0)) return 0.0;
  const double fold = std::cbrt(bending / (gravity * area_density));  // the radius of a fold [m]
  const double angle = std::min(1.0, spacing / fold);
  const double shortened = std::sin(angle / 4.0);  // squared, twice: 1 - cos(angle / 2), without cancellation
  const double curvature = angle / spacing;
  return bending * curvature * curvature / (16.0 * std::pow(shortened, 4.0));
}

}  // namespace

Springs springs_like(const Fem& sheet, double spacing, double area_density) {
  const double tension = std::sqrt(sheet.warp * sheet.weft), shear = sheet.shear;
  // A strip narrows as it is pulled: tension = along - shear^2 / along.
  const double along = 0.5 * (tension + std::hypot(tension, 2.0 * shear));
  Springs springs;
  springs.shear = shear;
  springs.bend = std::min(bend_of(sheet, spacing, area_density), std::max(0.0, along - shear) / 8.0);
  springs.structural = std::max(0.0, along - shear - 4.0 * springs.bend);
  // Dampers add up as springs do, and all kinds have the same.
  const double dampers = 1.0 + (shear > 0.0 ? 1.0 : 0.0) + (springs.bend > 0.0 ? 4.0 : 0.0);
  const double stretching = sheet.damping * along / dampers, slanting = sheet.damping * shear;
  springs.damping = shear > 0.0 ? std::min(stretching, slanting) : stretching;
  if (sheet.strain_limit)
    springs.strain_limit = std::min(sheet.strain_limit->warp, sheet.strain_limit->weft);  // springs have one
  return springs;
}

}  // namespace clothlab::scene
