#include "server/lab/measure/settling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/lab/measure/control.h"
#include "server/reference/methods.h"
#include "server/reference/rest_shape.h"
#include "server/reference/trajectory.h"

namespace clothlab::lab {

namespace {

/// The thick air's drag in units of sqrt(g / size), about the angular frequency of a hanging cloth's slowest
/// swing: with this drag the cloth comes to rest almost without swinging.
constexpr double drag = 1.5;
/// Settling time in units of sqrt(size / g): the slowest motion falls to 1e-5.
constexpr double settling_time_in_swings = 16.0;
constexpr std::uint32_t most_vertices = 4096;  // up to here Newton's method finds the balance in seconds

/// Why the scene has no shape of rest that can be computed; none if it may have one.
std::optional<Error> unfit(const reference::World& world) {
  for (const scene::Motion& motion : world.model.motions)
    if (scene::has_motion(motion))
      return Error{"rest", "a pin moves, so nothing comes to rest", "pins that stand still"};
  if (!world.scene.keys.empty())
    return Error{"rest", "keys change the scene, so nothing comes to rest", "no keys"};
  if (world.scene.wind) return Error{"rest", "the wind blows, so nothing comes to rest", "no wind"};
  if (!(glm::length(world.scene.gravity) > 0.0))
    return Error{"rest", "there is no gravity, so there is no shape of rest", "gravity"};
  if (world.model.vertex_count() > most_vertices)
    return Error{"rest",
                 std::to_string(world.model.vertex_count()) + " vertices are too many to find their balance",
                 "at most " + std::to_string(most_vertices)};
  return std::nullopt;
}

}  // namespace

Result<Settling> settle(const reference::World& world, double size, double budget,
                        const std::stop_token& stop) {
  if (const std::optional<Error> reason = unfit(world)) return *reason;
  Settling settling;
  const double g = glm::length(world.scene.gravity);
  settling.scene = world.scene;
  settling.scene.air_drag = std::max(world.scene.air_drag, drag * std::sqrt(g / size));
  settling.time = settling_time_in_swings * std::sqrt(size / g);

  reference::World thick = world;
  thick.scene = settling.scene;
  const auto steps = static_cast<int>(std::ceil(settling.time * reference::fastest_rate(thick)));
  const double dt = thick.scene.solver.dt = settling.time / steps;
  reference::State state = reference::at_rest(thick);
  const auto start = std::chrono::steady_clock::now();
  for (int n = 0; n < steps; ++n) {
    if (stop.stop_requested()) return cancelled;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > budget)
      return Error{"rest", "letting the reference settle takes too long",
                   "softer springs, a coarser mesh or a larger budget"};
    reference::advance(reference::rk4, thick, state, n * dt, (n + 1) * dt);
  }
  Result<reference::RestShape> shape = reference::rest_shape(thick, state.position, stop);
  if (stop.stop_requested()) return cancelled;
  if (!shape) return Error{"rest", "no shape of rest was found: " + shape.error().what, shape.error().remedy};
  settling.shape = std::move(shape->position);
  settling.reference_error = reference::rms_distance(settling.shape, state.position) / size;
  return settling;
}

Result<std::optional<double>> rest_error(const Settling& settling, const scene::Scene& scene, double size,
                                         TrialRunner& trials, const std::stop_token& stop) {
  const Result<std::optional<sim::State>> end = trials.run_to(scene, settling.time, stop);
  if (!end) return end.error();
  if (!*end) return std::optional<double>();
  const std::vector<glm::vec3>& read = (*end)->position;
  const double distance = reference::rms_distance({read.begin(), read.end()}, settling.shape);
  return std::isfinite(distance) ? std::optional<double>(distance / size) : std::nullopt;
}

}  // namespace clothlab::lab
