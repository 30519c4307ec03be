#include "server/reference/rest_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "server/reference/contacts.h"
#include "server/reference/system.h"
#include "server/reference/vectors.h"

namespace clothlab::reference {

namespace {

constexpr double balanced = 1e-12;  // force left over Scale::force: some thousand roundings
constexpr int most_iterations = 2000;

/// The sum of forces on each free vertex [N]; 0 on pinned vertices.
Vectors forces(const World& world, const Vectors& x) {
  Vectors force = element_forces(world, x, Vectors(x.size(), dvec3(0.0)));
  for (std::size_t i = 0; i < x.size(); ++i)
    force[i] = world.pinned(i) ? dvec3(0.0) : force[i] + world.model.mass[i] * world.scene.gravity;
  return force;
}

/// The largest stiffness over mass of any vertex [1/s^2], and the largest sum of forces, without signs, that
/// balance at any vertex [N].
struct Scale {
  double stiffness = 1e-300, force = 1e-300;
};
Scale scale(const World& world) {
  std::vector<double> stiffness(world.model.vertex_count(), 0.0), force(stiffness);
  model::each_element(world.model.elements, [&](const auto& element) {
    for (const std::uint32_t vertex : element.vertices) {
      stiffness[vertex] += element_stiffness(element.law);
      force[vertex] += element_stiffness(element.law) * element_size(element.law);
    }
  });
  Scale result;
  for (std::size_t i = 0; i < force.size(); ++i) {
    result.stiffness = std::max(result.stiffness, stiffness[i] / world.model.mass[i]);
    result.force = std::max(result.force, force[i] + world.model.mass[i] * glm::length(world.scene.gravity));
  }
  return result;
}

double potential(const World& world, const Vectors& x) {
  const Energy sum = energy(world, State{x, Vectors(x.size(), dvec3(0.0)), {}});
  return sum.elastic + sum.gravitational;
}

/// The first vertex from which no chain of elements leads to a pin; none if every vertex is held.
std::optional<std::size_t> unheld_vertex(const World& world) {
  std::vector<bool> held(world.model.vertex_count());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = world.pinned(i);
  for (bool spreading = true; spreading;) {
    spreading = false;
    model::each_element(world.model.elements, [&](const auto& element) {
      const auto is_held = [&](std::uint32_t vertex) { return held[vertex]; };
      const auto& corners = element.vertices;
      if (std::all_of(corners.begin(), corners.end(), is_held) ||
          std::none_of(corners.begin(), corners.end(), is_held))
        return;
      for (const std::uint32_t vertex : corners) held[vertex] = true;
      spreading = true;
    });
  }
  const auto found = std::find(held.begin(), held.end(), false);
  if (found == held.end()) return std::nullopt;
  return static_cast<std::size_t>(found - held.begin());
}

/// One step of Newton's method with `shift` [1/s^2] times the masses added to the stiffness (Levenberg). Uses
/// the true matrix if it is positive definite, else the matrix without the negative part of compressed
/// springs.
Vectors shifted_step(const World& world, const Vectors& x, const Vectors& force, double shift) {
  const Vectors still(x.size(), dvec3(0.0));
  Vectors dx;
  if (!solve_with_pins(world, system_matrix(world, x, {shift, 0.0, 1.0}, Across::kept), force, still, dx))
    solve_with_pins(world, system_matrix(world, x, {shift, 0.0, 1.0}, Across::dropped), force, still, dx);
  return dx;
}

/// Newton's method from `start`. The shift falls while steps lower the energy, and rises when they do not.
RestShape descend(const World& world, const Vectors& start, const std::stop_token& stop) {
  const Scale scales = scale(world);
  RestShape shape{start, 0.0, 0};
  double shift = 1e-2 * scales.stiffness, height = potential(world, shape.position);
  Vectors force = forces(world, shape.position);
  for (; shape.iterations < most_iterations; ++shape.iterations) {
    if (largest(force) <= balanced * scales.force || !(shift < 1e6 * scales.stiffness)) break;
    if (stop.stop_requested()) break;
    Vectors next = shifted_step(world, shape.position, force, shift);
    double expected = 0.0;  // the decrease of energy [J] that its slope alone predicts
    for (std::size_t i = 0; i < next.size(); ++i) {
      expected += glm::dot(next[i], force[i]);
      next[i] += shape.position[i];
    }
    const double height_next = potential(world, next);
    const Vectors force_next = forces(world, next);
    // At the minimum rounding hides the energy's decrease; the force shows the progress better.
    if (height_next < height - 0.1 * expected || largest(force_next) < 0.5 * largest(force)) {
      shape.position = next;
      force = force_next;
      height = height_next;
      shift *= 0.25;
    } else {
      shift = std::max(4.0 * shift, 1e-12 * scales.stiffness);
    }
  }
  shape.residual = largest(force);
  return shape;
}

/// An error if a free vertex of the shape x is inside a collider, or a spring or triangle is beyond its
/// strain limit.
std::optional<Error> violated(const World& world, const Vectors& x) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    dvec3 stopped = x[i], v(0.0);
    if (!world.pinned(i) && meet_colliders(world, 0.0, i, x[i], stopped, v) > 0)
      return Error{"/colliders", "vertex " + std::to_string(i) + " would hang inside a collider",
                   "a rest shape is found only where the cloth hangs clear of the colliders"};
  }
  for (const model::Spring& spring : world.model.springs()) {
    const auto [a, b] = spring.vertices;
    const std::uint32_t cloth = world.model.vertex_cloth[a];
    const std::optional<scene::StrainLimit> limit = world.scene.cloths[cloth].strain_limit();
    if (limit && glm::distance(x[a], x[b]) > (1.0 + limit->warp) * spring.law.rest_length)
      return Error{"/cloths/" + std::to_string(cloth) + "/material/strain_limit",
                   "the spring between vertices " + std::to_string(a) + " and " + std::to_string(b) +
                       " would be longer than its limit",
                   "a rest shape is found only where the limit does not act"};
  }
  for (const auto& triangle : world.model.elements.of<elements::Membrane>()) {
    const std::uint32_t cloth = world.model.vertex_cloth[triangle.vertices[0]];
    const std::optional<scene::StrainLimit> limit = world.scene.cloths[cloth].strain_limit();
    if (!limit) continue;
    const elements::Gradient f = elements::gradient(triangle.law, model::edges(triangle, 0, x));
    if (glm::length(f.warp) > 1.0 + limit->warp || glm::length(f.weft) > 1.0 + limit->weft)
      return Error{"/cloths/" + std::to_string(cloth) + "/material/strain_limit",
                   "the triangle at vertex " + std::to_string(triangle.vertices[0]) +
                       " would be longer than its limit",
                   "a rest shape is found only where the limit does not act"};
  }
  return std::nullopt;
}

}  // namespace

Result<RestShape> rest_shape(const World& world) {
  return rest_shape(world, world.model.rest_position, {});
}

Result<RestShape> rest_shape(const World& world, std::vector<dvec3> start, const std::stop_token& stop) {
  if (const std::optional<std::size_t> vertex = unheld_vertex(world))
    return Error{"/cloths/" + std::to_string(world.model.vertex_cloth[*vertex]) + "/pins",
                 "nothing holds vertex " + std::to_string(*vertex),
                 "every part of a cloth is pinned somewhere"};
  Vectors unused(start.size());
  place_pins(world, 0.0, start, unused);
  const RestShape shape = descend(world, start, stop);
  const double allowed = 1e-8 * scale(world).force;
  if (!(shape.residual <= allowed))
    return Error{
        "rest shape",
        "a force of " + std::to_string(shape.residual) + " N is left after " +
            std::to_string(shape.iterations) + " Newton steps",
        "at most " + std::to_string(allowed) + " N; a stiffer or less folded cloth converges better"};
  if (const std::optional<Error> error = violated(world, shape.position)) return *error;
  return shape;
}

}  // namespace clothlab::reference
