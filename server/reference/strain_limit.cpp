#include "server/reference/strain_limit.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "server/model/limit_shares.h"

namespace clothlab::reference {

namespace {

constexpr double enough = 1e-12;    // excess over rest length: some thousand roundings
constexpr int most_sweeps = 20000;  // Gauss-Seidel on a hanging cloth needs about rows^2 sweeps

/// Shortens one spring to (1 + limit) rest lengths if it is longer. Returns by how much it was too long, as a
/// share of its rest length.
double shorten(const World& world, const model::Spring& spring, double limit, std::vector<dvec3>& x) {
  const auto [a, b] = spring.vertices;
  const double wa = world.pinned(a) ? 0.0 : 1.0 / world.model.mass[a];
  const double wb = world.pinned(b) ? 0.0 : 1.0 / world.model.mass[b];
  const double rest_length = spring.law.rest_length;
  const dvec3 d = x[a] - x[b];
  const double length = glm::length(d), excess = length - (1.0 + limit) * rest_length;
  if (!(excess > 0.0) || wa + wb == 0.0) return 0.0;
  const dvec3 correction = d * (excess / (length * (wa + wb)));
  x[a] -= wa * correction;
  x[b] += wb * correction;
  return rest_length > 0.0 ? excess / rest_length : 0.0;
}

/// The same of a triangle's thread along warp (0) or weft (1), which has length 1 at rest.
double shorten(const World& world, const model::Element<elements::Membrane>& triangle, int along,
               double limit, std::vector<dvec3>& x) {
  const auto [first, second] = along == 0 ? std::pair(triangle.law.first_warp, triangle.law.second_warp)
                                          : std::pair(triangle.law.first_weft, triangle.law.second_weft);
  const std::array share{-(first + second), first, second};
  dvec3 thread(0.0);
  double growth = 0.0;
  for (std::size_t k = 0; k < share.size(); ++k) {
    const std::uint32_t corner = triangle.vertices[k];
    if (k > 0) thread += share[k] * (x[corner] - x[triangle.vertices[0]]);
    growth += share[k] * share[k] * (world.pinned(corner) ? 0.0 : 1.0 / world.model.mass[corner]);
  }
  const double length = glm::length(thread), excess = length - (1.0 + limit);
  if (!(excess > 0.0) || growth == 0.0) return 0.0;
  const dvec3 pull = thread * (excess / (length * growth));
  for (std::size_t k = 0; k < share.size(); ++k) {
    const std::uint32_t corner = triangle.vertices[k];
    if (!world.pinned(corner)) x[corner] -= share[k] / world.model.mass[corner] * pull;
  }
  return excess;
}

double sweep(const World& world, std::vector<dvec3>& x) {
  double worst = 0.0;
  for (const model::Spring& spring : world.model.springs()) {
    const std::uint32_t cloth = world.model.vertex_cloth[spring.vertices[0]];
    const std::optional<scene::StrainLimit> limit = world.scene.cloths[cloth].strain_limit();
    if (limit) worst = std::max(worst, shorten(world, spring, limit->warp, x));
  }
  for (const auto& triangle : world.model.elements.of<elements::Membrane>()) {
    const std::uint32_t cloth = world.model.vertex_cloth[triangle.vertices[0]];
    const std::optional<scene::StrainLimit> limit = world.scene.cloths[cloth].strain_limit();
    if (!limit) continue;
    worst = std::max(
        {worst, shorten(world, triangle, 0, limit->warp, x), shorten(world, triangle, 1, limit->weft, x)});
  }
  return worst;
}

bool any_limit(const World& world) {
  const std::vector<scene::Cloth>& cloths = world.scene.cloths;
  return std::any_of(cloths.begin(), cloths.end(),
                     [](const scene::Cloth& cloth) { return cloth.strain_limit().has_value(); });
}

/// Sweeps until no spring or thread is too long. Returns the largest excess in the last sweep.
double sweep_all(const World& world, std::vector<dvec3>& x) {
  double worst = sweep(world, x);
  for (int n = 1; worst > enough && n < most_sweeps; ++n) worst = sweep(world, x);
  return worst;
}

/// Gives the state each cloth's share of the corrections.
void take(const World& world, const std::vector<model::LimitShare>& shares, const std::vector<dvec3>& limited,
          State& state) {
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const auto& [place, velocity] = shares[world.model.vertex_cloth[i]];
    const dvec3 moved = limited[i] - state.position[i], gained = velocity * moved / world.scene.solver.dt;
    state.position[i] = place < 1.0 ? state.position[i] + place * moved : limited[i];
    state.velocity[i] += gained;
    if (!state.half_velocity.empty()) state.half_velocity[i] += gained;
  }
}

}  // namespace

double limit_strain(const World& world, State& state) {
  if (!any_limit(world)) return 0.0;
  std::vector<dvec3> limited = state.position;
  const double worst = sweep_all(world, limited);
  take(world, std::vector<model::LimitShare>(world.model.cloths.size()), limited, state);
  return worst;
}

double limit_strain(const World& world, const State& before, State& state) {
  if (!any_limit(world)) return 0.0;
  model::LimitedStep step{
      world.scene.solver.dt, {}, before.position, before.velocity, state.position, state.velocity,
      state.position};
  const double worst = sweep_all(world, step.limited);
  std::vector<model::LimitShare> shares(world.model.cloths.size());
  std::vector<dvec3> probe = before.position;
  if (worst > enough || sweep(world, probe) > enough) {
    for (std::size_t i = 0; i < probe.size(); ++i)
      step.inverse_mass.push_back(world.pinned(i) ? 0.0 : 1.0 / world.model.mass[i]);
    shares = model::limit_shares(world.model, step);
  }
  take(world, shares, step.limited, state);
  return worst;
}

}  // namespace clothlab::reference
