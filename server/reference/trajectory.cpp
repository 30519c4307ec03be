#include "server/reference/trajectory.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "server/model/wind.h"
#include "server/reference/methods.h"
#include "server/scene/keys.h"

namespace clothlab::reference {

namespace {

/// The states at `times` [s], by RK4 with equal steps of at most `largest_step` [s] between two times.
std::vector<State> follow(World world, const std::vector<double>& times, double largest_step) {
  std::vector<State> states;
  State state = at_rest(world);
  double from = 0.0;
  const auto go_to = [&](double time) {
    const auto steps = static_cast<int>(std::ceil((time - from) / largest_step - 1e-9));
    const double dt = (time - from) / steps;
    world.scene.solver.dt = dt;
    for (int n = 0; n < steps; ++n) advance(rk4, world, state, from + n * dt, from + (n + 1) * dt);
    from = time;
  };
  for (const double time : times) {
    const std::vector<double> ends = between_keys(world, from, time);
    std::for_each(ends.begin() + 1, ends.end(), go_to);
    states.push_back(state);
  }
  return states;
}

Error not_rising(double time, double after) {
  return {"times", std::to_string(time) + " s after " + std::to_string(after) + " s",
          "times that rise, from above 0"};
}

}  // namespace

Result<Trajectory> trajectory(const World& world, const std::vector<double>& times, double largest_step) {
  double before = 0.0;
  for (const double time : times) {
    if (!(time > before)) return not_rising(time, before);
    before = time;
  }
  const double step = largest_step > 0.0 ? largest_step : 0.02 / fastest_rate(world);
  const std::vector<State> coarse = follow(world, times, step);
  Trajectory result{follow(world, times, step / 2), {}, step / 2};
  for (std::size_t i = 0; i < times.size(); ++i) {
    result.error.push_back(rms_distance(coarse[i].position, result.states[i].position));
    if (!std::isfinite(result.error.back()))
      return Error{"trajectory", "the motion at " + std::to_string(times[i]) + " s is not finite",
                   "a smaller step than " + std::to_string(step) + " s"};
  }
  return result;
}

namespace {

double rate_of(const World& world) {
  const std::size_t count = world.model.vertex_count();
  std::vector<double> stiffness(count, 0.0), damping(count, 0.0);
  model::each_element(world.model.elements, [&](const auto& element) {
    for (const std::uint32_t vertex : element.vertices) {
      stiffness[vertex] += element_stiffness(element.law);
      damping[vertex] += element_damping(element.law);
    }
  });
  // Never 0: a sheet without springs moves too. The wind brakes, and gusts.
  double fastest = std::max({world.scene.air_drag, 2.0 * model::wind_rate(world.model, world.scene), 1e-3});
  if (world.scene.wind && world.scene.wind->gust > 0.0)
    fastest = std::max(fastest, 2.0 * std::numbers::pi * world.scene.wind->gust_frequency);
  for (std::size_t i = 0; i < count; ++i) {
    const double mass = world.model.mass[i];
    fastest = std::max(
        {fastest, std::sqrt(2.0 * stiffness[i] / mass), 2.0 * damping[i] / mass + world.scene.air_drag});
  }
  return fastest;
}

}  // namespace

double fastest_rate(const World& world) {
  if (world.scene.keys.empty()) return rate_of(world);
  World extreme = world;
  extreme.scene = scene::at_largest(world.scene);
  (void)model::take_materials(extreme.model, extreme.scene);
  return rate_of(extreme);
}

double rms_distance(const std::vector<dvec3>& a, const std::vector<dvec3>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace clothlab::reference
