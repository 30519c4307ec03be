#include "server/reference/sweeps.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "server/model/constraint_gains.h"
#include "server/reference/contacts.h"
#include "server/scene/method.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

using glm::dmat3;

/// The net force of elements and inertia on a vertex, times dt^2, and its negative derivative with respect to
/// the vertex's displacement. VBD moves the vertex so as to make the net force 0.
struct Balance {
  dvec3 residual{0.0};  ///< [kg m]
  dmat3 hessian{0.0};   ///< [kg], positive definite
};

Balance balance(const SweepState& step, std::uint32_t i) {
  const World& world = step.world;
  const double mass = 1.0 / step.mobility[i] + step.added_inertia[i], dt = step.dt;
  Balance result{
      mass * (step.free_displacement[i] + step.blown[i] + step.self_collision_push[i] - step.displacement[i]),
      dmat3(mass)};
  dvec3 diagonal(0.0), off_diagonal(0.0);
  world.model.elements.each([&](const auto& batch) {
    batch.at(i, [&](const auto& element, std::size_t corner) {
      const auto now = [&](std::uint32_t other) { return step.now(i) - step.now(other); };
      add_descent(law_at(element, corner), dt, edges(element, corner, now),
                  edges(element, corner, step.displacement), result.residual, diagonal, off_diagonal);
    });
  });
  result.hessian += dmat3(diagonal.x, off_diagonal.x, off_diagonal.y, off_diagonal.x, diagonal.y,
                          off_diagonal.z, off_diagonal.y, off_diagonal.z, diagonal.z);
  return result;
}

/// `move` [m] of vertex i, changed by the impulses of a collider that it would enter: one along the normal
/// that stops the vertex, and friction. `inverse` turns the impulses into displacements, as it does the
/// forces.
dvec3 stopped_move(SweepState& step, std::uint32_t i, const dmat3& inverse, dvec3 move) {
  const dvec3 trial = step.now(i) + move;
  dvec3 stopped = trial;
  Surface met;
  step.colliders_met[i] = stop_at_colliders_position(step.world, step.t, i, step.x[i], stopped, met);
  if (!step.world.scene.collides(scene::ContactKind::points))
    step.contacts[i] = step.colliders_met[i];  // else contact_pass counts
  if (step.colliders_met[i] == 0) return move;
  const dvec3& n = met.normal;
  const dvec3 response = inverse * n;
  const double impulse = glm::dot(stopped - trial, n) / glm::dot(n, response);
  move += response * impulse;
  const dvec3 slid = step.displacement[i] + move - step.dt * met.velocity;
  const dvec3 sliding = slid - n * glm::dot(slid, n);
  const double distance = glm::length(sliding);
  if (!(distance > 0.0)) return move;
  const dvec3 along = sliding / distance;
  dvec3 rubbed = inverse * along;  // friction moves the vertex only along the surface
  rubbed -= response * (glm::dot(n, rubbed) / glm::dot(n, response));
  const double most = met.friction * impulse;
  return move - (glm::dot(along, rubbed) * most < distance ? rubbed * most : sliding);
}

/// The displacement of vertex i by self-collision [m]; adds to `touched` how many vertices i touches.
dvec3 pair_push(const SweepState& step, std::uint32_t i, int& touched) {
  const World& world = step.world;
  const scene::SelfCollision& self = *world.scene.self_collision;
  // Removing an old overlap at once would act like a blow: remove a fifth in a step, less in short steps.
  const double overlap_share_removed = std::min(0.2, 20.0 * step.dt);
  dvec3 push(0.0);
  for (std::uint32_t j = 0; j < world.model.vertex_count(); ++j) {
    const dvec3 before = step.x[i] - step.x[j], now = step.now(i) - step.now(j);
    if (glm::length(before) > self.thickness + glm::distance(before, now)) continue;  // cannot meet
    const std::optional<double> keep = kept_distance(world, i, j);
    dvec3 correction;
    if (!keep ||
        !elements::pair_contact(before, now, *keep, self.friction, overlap_share_removed, correction))
      continue;
    ++touched;
    const double contact_count = std::max({2, step.contacts[i], step.contacts[j]});
    push += step.mobility[i] / (step.mobility[i] + step.mobility[j]) / contact_count * correction;
  }
  return push;
}

template <class Law>
void visit(SweepState& step, const model::Element<Law>& element, elements::Edges<Law>& pushed) {
  const auto& vertices = element.vertices;
  double inverse_mass = 0.0;
  for (const std::uint32_t vertex : vertices) inverse_mass += step.mobility[vertex];
  if (inverse_mass == 0.0) return;
  const elements::ConstraintGains gains =
      model::constraint_gains(step.world.scene.solver, element.law, inverse_mass);
  const SweepState& so_far = step;
  const auto moved = model::edges(element, 0, so_far.displacement);
  auto place = model::edges(element, 0, so_far.x);
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) place.d[k] += moved.d[k];
  double mobility[element.corners];
  for (std::size_t k = 0; k < vertices.size(); ++k) mobility[k] = step.mobility[vertices[k]];
  auto remembered = pushed;
  const auto push = elements::element_visit(element.law, gains, mobility, place, moved, remembered);
  if (gains.memory > 0.0) pushed = remembered;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    step.displacement[vertices[0]] += step.mobility[vertices[0]] * push.d[k];
    step.displacement[vertices[k + 1]] -= step.mobility[vertices[k + 1]] * push.d[k];
  }
}

}  // namespace

void sweep_elements(SweepState& step) {
  const World& world = step.world;
  world.model.elements.each_swept([&]<class Law>(const model::Batch<Law>& batch) {
    for (const std::uint32_t element :
         world.element_colours[elements::law_number<Law, elements::SweptLaws>].order)
      visit(step, batch[element], std::get<Pushes<Law>>(step.pushed)[element]);
  });
}

void sweep_vertices(SweepState& step) {
  const bool colliders = step.world.scene.has_solids();
  for (const std::uint32_t i : step.world.vertex_colours.order) {
    if (step.mobility[i] == 0.0) continue;
    const Balance at = balance(step, i);
    const dmat3 inverse = glm::inverse(at.hessian);
    const dvec3 move = inverse * at.residual;
    step.displacement[i] += colliders ? stopped_move(step, i, inverse, move) : move;
  }
}

void contact_pass(SweepState& step) {
  const World& world = step.world;
  const bool remembers = scene::sweeps_vertices(world.scene.solver.method);
  std::vector<dvec3> push(step.x.size(), dvec3(0.0));
  std::vector<int> contacts(step.x.size(), 0);
  for (std::uint32_t i = 0; world.scene.collides(scene::ContactKind::points) && i < push.size(); ++i)
    if (step.mobility[i] > 0.0) push[i] = pair_push(step, i, contacts[i]);
  for (std::uint32_t i = 0; i < push.size(); ++i) {
    if (step.mobility[i] == 0.0) continue;
    dvec3& d = step.displacement[i];
    d += push[i];
    if (remembers) step.self_collision_push[i] += push[i];
    const dvec3 trial = step.now(i);
    dvec3 stopped = trial;
    Surface met;
    const int count = stop_at_colliders_position(world, step.t, i, step.x[i], stopped, met);
    contacts[i] +=
        std::max(count, step.colliders_met[i]);  // VBD's visit may have put the vertex on the surface
    if (count == 0) continue;
    d += stopped - trial;
    d -= elements::friction_displacement(d - step.dt * met.velocity, met.normal, met.friction,
                                         glm::dot(stopped - trial, met.normal));
  }
  step.contacts = contacts;
}

void balance_momentum(SweepState& step) {
  const World& world = step.world;
  if (world.scene.has_solids()) return;
  for (const model::ClothRange& cloth : world.model.cloths) {
    dvec3 lacking(0.0);
    double mass = 0.0;
    bool free = true;
    const std::uint32_t first = cloth.first_vertex, end = first + cloth.vertex_count;
    for (std::uint32_t i = first; i < end; ++i) {
      free = free && !world.pinned(i);
      const double inertia = step.added_inertia[i] + world.model.mass[i] / model::mobility(world.scene);
      lacking += inertia * (step.free_displacement[i] + step.blown[i] + step.self_collision_push[i] -
                            step.displacement[i]);
      mass += inertia;
    }
    for (std::uint32_t i = first; free && i < end; ++i) step.displacement[i] += lacking / mass;
  }
}

}  // namespace clothlab::reference
