#include "server/scene/fitted_springs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

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

double twice_area_of(const TriangleMesh& mesh, std::size_t triangle) {
  if (!mesh.pattern.empty()) {
    const auto& [a, b, c] = mesh.pattern[triangle];
    return std::abs((b - a).x * (c - a).y - (b - a).y * (c - a).x);
  }
  const auto& [a, b, c] = mesh.triangles[triangle];
  return glm::length(glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
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

double area(const Mesh& mesh) {
  if (const Grid* grid = std::get_if<Grid>(&mesh)) return grid->width * grid->height;
  const TriangleMesh& triangles = std::get<TriangleMesh>(mesh);
  double twice_area = 0.0;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i) twice_area += twice_area_of(triangles, i);
  return 0.5 * twice_area;
}

double grid_spacing(const Mesh& mesh) {
  if (const Grid* grid = std::get_if<Grid>(&mesh))
    return std::sqrt(grid->width / (grid->columns - 1) * grid->height / (grid->rows - 1));
  const std::size_t vertices = std::get<TriangleMesh>(mesh).vertices.size();
  return std::sqrt(area(mesh) / static_cast<double>(std::max<std::size_t>(1, vertices)));
}

}  // namespace clothlab::scene
