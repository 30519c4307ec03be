#include "server/model/wind.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/elements/elements.h"

namespace clothlab::model {

namespace {

/// Twice the area of a triangle at rest [m^2].
double doubled_area(const Model& model, const std::array<std::uint32_t, 3>& corners) {
  const dvec3 &a = model.rest_position[corners[0]], &b = model.rest_position[corners[1]],
              &c = model.rest_position[corners[2]];
  return glm::length(glm::cross(b - a, c - a));
}

}  // namespace

double largest_wind_speed(const scene::Wind& wind) {
  return glm::length(wind.velocity) * (1.0 + (wind.gust_frequency > 0.0 ? wind.gust : 0.0));
}

double wind_rate(const Model& model, const scene::Scene& scene) {
  if (!scene.wind) return 0.0;
  const double speed = largest_wind_speed(*scene.wind);
  std::vector<double> braking(model.vertex_count(), 0.0);
  for (const auto& corners : model.triangles) {
    const elements::WindLoad load =
        elements::wind_load({scene.wind->drag, scene.wind->lift}, dvec3(speed, 0.0, 0.0),
                            {doubled_area(model, corners), 0.0, 0.0});
    for (const std::uint32_t corner : corners) braking[corner] += load.braking / 3.0;
  }
  double most = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] == not_pinned) most = std::max(most, braking[i] / model.mass[i]);
  return most;
}

double largest_wind_power(const Model& model, const scene::Scene& scene) {
  if (!scene.wind) return 0.0;
  double area = 0.0;
  for (const auto& corners : model.triangles) area += 0.5 * doubled_area(model, corners);
  return 0.5 * elements::air_density * area * std::pow(largest_wind_speed(*scene.wind), 3) *
         (4.0 / 27.0 * scene.wind->drag + 2.0 * scene.wind->lift);
}

}  // namespace clothlab::model
