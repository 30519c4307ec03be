#include "server/model/sweep_stretch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <utility>
#include <vector>

#include "server/base/text.h"
#include "server/model/remedy.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"

namespace clothlab::model {

namespace {

/// An edge from a pinned vertex to a free one.
struct Holding {
  std::uint32_t free = 0;
  double length = 0, stiffness = 0;  ///< at rest [m], [N/m]; a finite element's edge: 0
};

bool pinned(const Model& model, std::uint32_t vertex) {
  return model.pin_motion[vertex] != not_pinned;
}

std::vector<Holding> edges_at_pins(const Model& model, std::uint32_t cloth) {
  std::vector<Holding> found;
  const auto consider = [&](std::uint32_t a, std::uint32_t b, double stiffness) {
    if (model.vertex_cloth[a] != cloth || pinned(model, a) == pinned(model, b)) return;
    found.push_back(
        {pinned(model, a) ? b : a, glm::distance(model.rest_position[a], model.rest_position[b]), stiffness});
  };
  for (const Spring& spring : model.springs())
    consider(spring.vertices[0], spring.vertices[1], spring.law.stiffness);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& triangle : model.elements.of<elements::Membrane>())
    for (std::size_t k = 0; k < 3; ++k)
      edges.insert(std::minmax(triangle.vertices[k], triangle.vertices[(k + 1) % 3]));
  for (const auto& [a, b] : edges) consider(a, b, 0.0);
  return found;
}

/// Springs that only bend are soft, and carry nothing.
void leave_soft_ones_out(std::vector<Holding>& edges) {
  double stiffest = 0.0;
  for (const Holding& edge : edges) stiffest = std::max(stiffest, edge.stiffness);
  std::erase_if(edges, [&](const Holding& edge) { return edge.stiffness < 0.3 * stiffest; });
}

double weight(const Model& model, const scene::Scene& scene, std::uint32_t cloth) {
  double mass = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (!pinned(model, i) && (scene.self_collision || model.vertex_cloth[i] == cloth)) mass += model.mass[i];
  return mass * glm::length(scene.gravity);
}

/// By the method: what was measured, over the estimate.
double measured_share(scene::Method method) {
  return method == scene::Method::pbd ? 2.0 : 1.15;
}

}  // namespace

HangingStretch hanging_stretch(const Model& model, const scene::Scene& scene) {
  HangingStretch stretch;
  const scene::Solver& solver = scene.solver;
  for (std::uint32_t cloth = 0; cloth < model.cloths.size(); ++cloth) {
    std::vector<Holding> edges = edges_at_pins(model, cloth);
    leave_soft_ones_out(edges);
    const double pull = edges.empty() ? 0.0 : weight(model, scene, cloth) / static_cast<double>(edges.size());
    for (const Holding& edge : edges) {
      if (!(edge.length > 0.0)) continue;
      if (edge.stiffness > 0.0)
        stretch.by_law = std::max(stretch.by_law, pull / (edge.stiffness * edge.length));
      if (!scene::sweeps(solver.method)) continue;
      const double moved = pull * solver.dt * solver.dt / (solver.iterations * model.mass[edge.free]);
      stretch.by_sweeps = std::max(stretch.by_sweeps, measured_share(solver.method) * moved / edge.length);
    }
  }
  return stretch;
}

std::string sweeps_warning(const Model& model, const scene::Scene& scene) {
  constexpr double much = 0.2, little = 0.02;
  const scene::Solver& solver = scene.solver;
  if (solver.automatic) return {};
  const HangingStretch stretch = hanging_stretch(model, scene);
  if (stretch.by_sweeps < std::max(much, stretch.by_law)) return {};
  const double too_much = stretch.by_sweeps / std::max(little, stretch.by_law);
  const double dt = rounded_down(solver.dt / std::sqrt(too_much));
  const double enough = std::ceil(solver.iterations * too_much);
  constexpr double far = 10.0;  // beyond any cloth; the estimate then says no more
  return formatted("%d %s of %s in a step of %.3g s are too few for this cloth: where it hangs ",
                   solver.iterations, solver.iterations == 1 ? "sweep" : "sweeps", scene::name(solver.method),
                   solver.dt) +
         (solver.method == scene::Method::vbd ? "or swings " : "") +
         (stretch.by_sweeps > far
              ? std::string("it will stretch to many times its length")
              : formatted("it will stretch by about %.0f %%", 100.0 * stretch.by_sweeps)) +
         (stretch.by_law > 0.0 ? formatted(", not by %.2g %%", 100.0 * stretch.by_law) : std::string()) +
         formatted("; dt = %.2g s holds, or ", dt) +
         (enough <= scene::ranges::iterations.maximum ? formatted("%.0f iterations, or ", enough)
                                                      : std::string()) +
         "the method implicit_euler";
}

}  // namespace clothlab::model
