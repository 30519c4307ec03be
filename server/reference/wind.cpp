#include "server/reference/wind.h"

#include <glm/geometric.hpp>

#include "server/model/motion.h"

namespace clothlab::reference {

std::vector<elements::WindLoad> wind_loads(const World& of, const std::vector<dvec3>& x,
                                           const std::vector<dvec3>& v, double t) {
  const World& world = at_time(of, t);
  std::vector<elements::WindLoad> loads(x.size(), {dvec3(0.0), 0.0});
  if (!world.scene.wind) return loads;
  const scene::Wind& wind = *world.scene.wind;
  const dvec3 air = model::wind_velocity(wind, t);
  for (const auto& [a, b, c] : world.model.triangles) {
    const dvec3 crossed = glm::cross(x[b] - x[a], x[c] - x[a]);
    const elements::WindLoad load =
        elements::wind_load({wind.drag, wind.lift}, air - (v[a] + v[b] + v[c]) / 3.0, crossed);
    for (const std::uint32_t corner : {a, b, c}) {
      loads[corner].force += load.force / 3.0;
      loads[corner].braking += load.braking / 3.0;
    }
  }
  return loads;
}

void add_wind(const World& world, const std::vector<dvec3>& x, const std::vector<dvec3>& v, double t,
              std::vector<dvec3>& acceleration) {
  if (!world.scene.wind) return;
  const double most = world.scene.solver.method == scene::Method::verlet ? elements::most_of_flow_predicted
                                                                         : elements::most_of_flow;
  const std::vector<elements::WindLoad> loads = wind_loads(world, x, v, t);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double inverse_mass = 1.0 / world.model.mass[i];
    acceleration[i] +=
        loads[i].force *
        (inverse_mass * elements::wind_share(world.scene.solver.dt, inverse_mass, loads[i].braking, most));
  }
}

}  // namespace clothlab::reference
