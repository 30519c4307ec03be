#include "server/sim/blow_up.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <vector>

#include "server/base/text.h"
#include "server/model/wind.h"
#include "server/scene/keys.h"
#include "server/scene/method.h"
#include "server/scene/solid.h"

namespace clothlab::sim {

namespace {

constexpr double growth_that_proves = 4.0, proved_already = 1.0;
constexpr int patience = 60;           // judgements after which a doubt is reviewed: about a second
constexpr double share_of_good = 0.1;  // a state is good up to this share of the excess that is allowed

/// True if the state, its energies and its forces are finite. Forces overflow before energies do, and the
/// work of an infinite force would excuse any growth.
bool finite(const Diagnostics& state) {
  return state.finite && std::isfinite(state.total_energy()) && std::isfinite(state.pin_force) &&
         std::isfinite(state.contact_force);
}

/// The largest speed [m/s] that `motion` ever gives to a point within `reach` [m] of `where`.
double largest_speed(const scene::Motion& motion, const glm::dvec3& where, double reach) {
  if (const auto* swing = std::get_if<scene::Oscillate>(&motion))
    return std::abs(2.0 * std::numbers::pi * swing->frequency * swing->amplitude);
  if (const auto* line = std::get_if<scene::Linear>(&motion)) return glm::length(line->velocity);
  if (const auto* spin = std::get_if<scene::Spin>(&motion))
    return std::abs(glm::radians(spin->degrees_per_second)) * (glm::distance(where, spin->center) + reach);
  if (const auto* placed = std::get_if<scene::Placed>(&motion)) {
    const double gliding = 1.5 / scene::Placed::glide * glm::distance(where, placed->place);
    return gliding + std::visit([&](const auto& then) { return largest_speed(then, placed->place, reach); },
                                placed->then);
  }
  return 0.0;
}

double collider_speed(const scene::Collider& collider, double size) {
  const scene::Ball bounds = scene::bounds(collider.shape);
  // The cloth touches an unbounded shape (a plane) only near itself: points within the cloth's size count.
  return largest_speed(collider.motion, bounds.center, std::isinf(bounds.radius) ? size : bounds.radius);
}

/// What the allowance takes from one cloth.
struct Scale {
  double size = 0;       ///< diagonal of the box about the rest shape [m]
  double farthest = 0;   ///< largest coordinate [m]
  double mass = 0;       ///< of the vertices that no pin holds [kg]
  double pin_speed = 0;  ///< of the fastest pin [m/s]
};

Scale scale_of(const model::Model& model, const model::ClothRange& cloth) {
  glm::dvec3 low(1e300), high(-1e300);
  Scale scale;
  for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
    const glm::dvec3& x = model.rest_position[i];
    low = glm::min(low, x);
    high = glm::max(high, x);
    const std::int32_t pin = model.pin_motion[i];
    if (pin == model::not_pinned)
      scale.mass += model.mass[i];
    else
      scale.pin_speed =
          std::max(scale.pin_speed, largest_speed(model.motions[static_cast<std::size_t>(pin)], x, 0.0));
  }
  const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
  scale.size = glm::distance(low, high);
  scale.farthest = std::max({far.x, far.y, far.z});
  return scale;
}

/// Allowance::energy_ratio.
double stable_swing(double dt, double dt_limit) {
  constexpr double nearest = 0.95, at_least = 2.0, known_unstable = 4.0;
  if (std::isinf(dt_limit)) return at_least;
  if (dt >= dt_limit) return known_unstable;
  const double share = std::min(dt / dt_limit, nearest);
  return std::max(at_least, (1.0 + share) / (1.0 - share));
}

}  // namespace

Allowance allowance(const scene::Scene& keyed, const model::Model& model, double dt_limit) {
  const scene::Scene scene = keyed.keys.empty() ? keyed : scene::at_largest(keyed);
  const double stiffer = scene::stiffness_growth(keyed);
  Allowance allowed;
  const double wind = scene.wind ? model::largest_wind_speed(*scene.wind) : 0.0;
  std::vector<double> farthest;
  for (const model::ClothRange& range : model.cloths) {
    const Scale cloth = scale_of(model, range);
    double near = 0.0;
    for (const scene::Collider& collider : scene.colliders)
      near = std::max(near, collider_speed(collider, cloth.size));
    allowed.pin_speed = std::max(allowed.pin_speed, cloth.pin_speed);
    allowed.collider_speed = std::max(allowed.collider_speed, near);
    const double speed = cloth.pin_speed + near;
    allowed.slack_energy += cloth.mass * (0.25 * glm::length(scene.gravity) * cloth.size +
                                          2.0 * speed * speed + 0.5 * wind * wind);
    farthest.push_back(cloth.farthest);
    if (scene::has_key(keyed, "/gravity")) allowed.weight += cloth.mass * glm::length(scene.gravity);
  }
  const double push = scene.self_collision ? 0.2 * scene.self_collision->thickness : 0.0;
  double elastic = 0.0;
  model::each_element(model.elements, [&](const auto& element) {
    // The push of self-collision, a thousandth of the element's size, and float32's rounding of coordinates.
    const double stretch =
        push + 1e-3 * element_size(element.law) + 1e-6 * farthest[model.vertex_cloth[element.vertices[0]]];
    elastic += 0.5 * element_stiffness(element.law) * stretch * stretch;
  });
  allowed.slack_energy += stiffer * elastic;
  allowed.wind_power = model::largest_wind_power(model, scene);
  allowed.energy_ratio = stiffer * stable_swing(scene.solver.dt, dt_limit);
  allowed.counts_elastic = !scene::sweeps(scene.solver.method);
  allowed.growth = scene.solver.dt > dt_limit ? proved_already : growth_that_proves;
  return allowed;
}

bool changes_energy(const scene::Scene& from, scene::Scene to) {
  to.solver = from.solver;
  return change_depth(from, to) != ChangeDepth::none;
}

void BlowUp::start(const Allowance& allowance, const Diagnostics& diagnosis) {
  *this = BlowUp();
  allowance_ = allowance;
  const Diagnostics state = seen(diagnosis);
  ledger_ = state.total_energy();
  last_ = state;
  last_good_ = diagnosis;
}

void BlowUp::rebase(const Diagnostics& diagnosis) {
  const Diagnostics state = seen(diagnosis);
  const double before = growing_energy(last_);
  ledger_ += state.total_energy() - last_.total_energy();
  if (before > 0.0) doubted_energy_ *= growing_energy(state) / before;
  last_ = state;
}

/// The work [J] that pins, colliders and wind may have done since the last state. Of pins and colliders:
/// their largest speed at any time, times the larger of the forces in the two states, times the time between.
/// A collider also throws the vertices that it hits, at up to twice its speed. Of hands: their pull, over the
/// way of the fastest vertex and the way within which it may have come and gone.
double BlowUp::work_since_last(const Diagnostics& state) const {
  const double seconds = state.time - last_.time;
  const double pins = allowance_.pin_speed * std::max(state.pin_force, last_.pin_force);
  const double colliders = allowance_.collider_speed * std::max(state.contact_force, last_.contact_force);
  const double pulled =
      allowance_.hand_force * (seconds * std::max(state.max_speed, last_.max_speed) + allowance_.hand_reach);
  const double thrown = 2.0 * allowance_.collider_speed * allowance_.collider_speed * state.contact_mass;
  const double fallen = allowance_.weight * std::max(state.max_speed, last_.max_speed);
  return seconds * (pins + colliders + allowance_.wind_power + fallen) + pulled + thrown;
}

BlowUp::Verdict BlowUp::judge(const Diagnostics& diagnosis) {
  const Diagnostics state = seen(diagnosis);
  if (!finite(state)) {
    last_ = state;
    return Verdict::blown_up;
  }
  const double work = work_since_last(state);
  work_ += work;
  ledger_ += work;
  const double available = std::max(0.0, ledger_ - state.gravitational);
  const double allowed_excess = (allowance_.energy_ratio - 1.0) * available + allowance_.slack_energy;
  allowed_ = available + allowed_excess;
  const double excess = growing_energy(state) - available;
  ledger_ = std::min(ledger_, state.total_energy());
  last_ = state;
  if (excess > allowed_excess) return judge_doubtful(state);
  doubted_energy_ = 0.0;
  if (excess > share_of_good * allowed_excess) return Verdict::doubtful;
  last_good_ = diagnosis;
  work_ = 0.0;
  return Verdict::good;
}

BlowUp::Verdict BlowUp::judge_doubtful(const Diagnostics& state) {
  const double energy = growing_energy(state);
  if (doubted_energy_ == 0.0) {
    doubted_energy_ = energy;
    doubted_for_ = 0;
  }
  if (energy >= allowance_.growth * doubted_energy_) return Verdict::blown_up;
  if (++doubted_for_ < patience) return Verdict::doubtful;
  doubted_for_ = 0;
  if (energy > doubted_energy_) return Verdict::doubtful;  // the energy still grows, slowly
  start(allowance_, state);
  return Verdict::good;
}

std::string BlowUp::reason() const {
  if (!finite(last_))
    return formatted(
        "positions, velocities or forces stopped being finite numbers between t = %.4g s and t = %.4g s",
        last_good_.time, last_.time);
  return formatted(
      "the energy of motion%s grew from %.3g J at t = %.4g s to %.3g J at t = %.4g s, "
      "with at most %.3g J of work done on the cloth and %.3g J released by falling",
      allowance_.counts_elastic ? " and stretch" : "", growing_energy(last_good_), last_good_.time,
      growing_energy(last_), last_.time, work_,
      std::max(0.0, seen(last_good_).gravitational - last_.gravitational));
}

}  // namespace clothlab::sim
