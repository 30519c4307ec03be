#include "server/model/limit_shares.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::model {

namespace {

constexpr double energy_rounding = 1e-5;      // of the energies that are compared: places are 32-bit floats
constexpr double least_place_share = 0x1p-6;  // of the corrections of places

/// Elastic energy of each cloth [J].
std::vector<double> elastic(const Model& model, const std::vector<dvec3>& place) {
  std::vector<double> energy(model.cloths.size(), 0.0);
  each_element(model.elements, [&](const auto& element) {
    energy[model.vertex_cloth[element.vertices[0]]] += element_energy(element.law, edges(element, 0, place));
  });
  return energy;
}

/// The mean velocity of the cloth's pins in the step [m/s]; without pins any does.
dvec3 pins_velocity(const ClothRange& cloth, const LimitedStep& step) {
  dvec3 sum(0.0);
  double pins = 0.0;
  for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
    if (step.inverse_mass[i] > 0.0) continue;
    sum += (step.free[i] - step.start[i]) / step.dt;
    pins += 1.0;
  }
  return pins > 0.0 ? sum / pins : dvec3(0.0);
}

/// Kinetic energy [J] at the start, and with a share s of the corrections' velocity: free + s linear + s^2
/// square.
struct Kinetic {
  double start = 0, free = 0, linear = 0, square = 0;
  bool pins_move = false;  ///< in this step

  Kinetic(const ClothRange& cloth, const LimitedStep& step) {
    const dvec3 pins = pins_velocity(cloth, step);
    for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
      pins_move = pins_move || (step.inverse_mass[i] == 0.0 && step.free[i] != step.start[i]);
      if (!(step.inverse_mass[i] > 0.0)) continue;
      const double mass = 1.0 / step.inverse_mass[i];
      const dvec3 before = step.start_velocity[i] - pins, now = step.free_velocity[i] - pins,
                  gained = (step.limited[i] - step.free[i]) / step.dt;
      start += 0.5 * mass * glm::dot(before, before);
      free += 0.5 * mass * glm::dot(now, now);
      linear += mass * glm::dot(now, gained);
      square += 0.5 * mass * glm::dot(gained, gained);
    }
  }

  /// The largest share, at most `most`, that adds no more than `spare` [J], which is 0 or more.
  double share_within(double most, double spare) const {
    if (most * (linear + most * square) <= spare) return most;
    return std::min(most, (std::sqrt(linear * linear + 4.0 * square * spare) - linear) / (2.0 * square));
  }
};

}  // namespace

std::vector<LimitShare> limit_shares(const Model& model, const LimitedStep& step) {
  const std::vector<double> at_start = elastic(model, step.start), free = elastic(model, step.free);
  std::vector<LimitShare> shares(model.cloths.size(), LimitShare{0.0, 0.0});
  std::vector<char> open(model.cloths.size(), 1);
  std::vector<Kinetic> motion;
  for (const ClothRange& cloth : model.cloths) motion.emplace_back(cloth, step);
  std::vector<dvec3> place = step.limited;
  for (double share = 1.0; share >= least_place_share && std::count(open.begin(), open.end(), 1) > 0;
       share *= 0.5) {
    if (share < 1.0)
      for (std::size_t i = 0; i < place.size(); ++i)
        place[i] = step.free[i] + share * (step.limited[i] - step.free[i]);
    const std::vector<double> now = elastic(model, place);
    for (std::size_t c = 0; c < shares.size(); ++c) {
      if (!open[c]) continue;
      const double most = std::max(free[c] + motion[c].free, at_start[c] + motion[c].start);
      const double spare = most * (1.0 + energy_rounding) - now[c] - motion[c].free;
      // Velocities may take energy from the cloth, but not to pay for a place that has more.
      if (motion[c].pins_move && !(spare >= 0.0)) continue;
      shares[c] = {share, motion[c].pins_move ? motion[c].share_within(share, spare) : share};
      open[c] = 0;
    }
  }
  return shares;
}

}  // namespace clothlab::model
