#include "server/sim/cost.h"

#include <algorithm>
#include <cmath>

#include "server/model/size.h"
#include "server/scene/method.h"
#include "server/scene/sections.h"

namespace clothlab::sim {

namespace {

// Costs [s] for each vertex, measured with tests/bench/step.mjs and methods.mjs.
constexpr double gather = 50e-9;       ///< one evaluation of the forces
constexpr double wind = 1.5 * gather;  ///< in one evaluation: it reads as many vertices as `gather`, and
                                       ///< takes two square roots a triangle
/// Contact of points in one step, without the neighbour search: on a grid for each vertex that a search looks
/// at (77 at 25x25 vertices of the seed's cloth, 131 ns; 204 at 48x48, 340 ns), in a heap for all together.
constexpr double contact_on_grid = 1.7e-9, contact_in_heap = 150e-9;
constexpr double surface_contacts = 1.1e-6;  ///< of surfaces in one step, with the searches while folds snap
constexpr double sweep = 210e-9;             ///< one sweep of PBD, XPBD or VBD
constexpr double newton = 3.4e-6;  ///< one Newton step of implicit Euler, which rarely takes more than two
constexpr double strain_limit_cost = 20 * gather;  ///< the strain limit's sweeps in one step
constexpr double pair_cost = 3e-9;                 ///< one other vertex that a neighbour search looks at
constexpr double searches_per_step = 0.05;  ///< number of neighbour searches per step while a cloth moves

/// The cost of contact of points for each vertex [s]. On a grid that starts flat the number of vertices that
/// a neighbour search looks at (crowding.h) follows from the spacing; any other cloth is taken to lie in a
/// heap, where it looks at all.
double cost_of_points(const scene::Cloth& cloth, double thickness) {
  constexpr double search = searches_per_step * pair_cost;
  const double vertices = static_cast<double>(scene::vertex_count(cloth.mesh));
  const auto* grid = std::get_if<scene::Grid>(&cloth.mesh);
  if (!grid || cloth.start != scene::Cloth().start) return contact_in_heap + search * vertices;
  const double edge = cloth.transform.scale * std::max(grid->width / std::max(grid->columns - 1, 1),
                                                       grid->height / std::max(grid->rows - 1, 1));
  const double reach = thickness + std::max(edge, 0.5 * thickness);
  return (contact_on_grid + search) * std::min(vertices, std::pow(4.0 * reach / edge, 2));
}

}  // namespace

double expected_step_seconds(const scene::Scene& scene) {
  const double iterations = scene.solver.iterations;
  double cost_per_vertex = scene::facts(scene.solver.method).evaluations * gather;
  if (scene.wind) cost_per_vertex += scene::facts(scene.solver.method).evaluations * wind;
  if (scene::sweeps(scene.solver.method)) cost_per_vertex += iterations * sweep;
  if (scene::solves(scene.solver.method)) cost_per_vertex += std::min(iterations, 2.0) * newton;
  double total = 0.0;
  for (const scene::Cloth& cloth : scene.cloths) {
    double cost = cost_per_vertex;
    if (cloth.strain_limit()) cost += strain_limit_cost;
    if (scene.collides(scene::ContactKind::surface))
      cost += surface_contacts;
    else if (scene.self_collision)
      cost += cost_of_points(cloth, scene.self_collision->thickness);
    total += cost * static_cast<double>(scene::vertex_count(cloth.mesh));
  }
  return total;
}

double expected_share(const scene::Scene& scene) {
  return expected_step_seconds(scene) / scene.solver.dt;
}

}  // namespace clothlab::sim
