#include "server/session/rest.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "server/scene/keys.h"

namespace clothlab::session {

namespace {

// A viewer sees the cloth fill the 720 lines of a picture, so that a pixel is a 720th of the cloth's size.
constexpr double pixel = 1.0 / 720;
constexpr double pixels_a_second = 10;
// So small a swing cannot be seen, and a cloth that creeps so slowly takes 50 stretches for a pixel.
constexpr double pixels_a_stretch = 0.02;
// Where surfaces lie on each other, their few passes leave a creep that takes 3 stretches for a pixel, and
// speeds, of vertices that go nowhere, of somewhat more than gravity gives in a step.
constexpr double pixels_on_surfaces = 0.3, falls_on_surfaces = 2;
// Rounding moves coordinates in float32 by up to this many units in the last place.
constexpr double roundings = 4;
constexpr double pi = 3.14159265358979;
// No cloth swings slower than a pendulum as long as its diagonal; a cloth that hangs as a chain from a corner
// swings faster. The stretch is 1.5 times half the pendulum's period.
constexpr double diagonal = 1.4143, margin = 1.5;
// Without gravity only the springs move a cloth back, and the pendulum's period is infinite: hence a maximum.
constexpr double shortest_stretch = 1, longest_stretch = 15;  // [s]

bool moves(const scene::Motion& motion) {
  if (const auto* oscillate = std::get_if<scene::Oscillate>(&motion))
    return oscillate->amplitude != 0 && oscillate->frequency != 0;
  if (const auto* linear = std::get_if<scene::Linear>(&motion)) return linear->velocity != scene::dvec3(0.0);
  if (const auto* spin = std::get_if<scene::Spin>(&motion)) return spin->degrees_per_second != 0;
  if (const auto* placed = std::get_if<scene::Placed>(&motion))
    return std::visit([](const auto& then) { return moves(then); }, placed->then);
  return false;
}

bool gusts(const scene::Wind& wind) {
  return wind.velocity != scene::dvec3(0.0) && wind.gust != 0 && wind.gust_frequency != 0;
}

bool is_driven(const scene::Scene& scene) {
  const auto moving = [](const auto& holder) { return moves(holder.motion); };
  if (scene.wind && gusts(*scene.wind)) return true;
  return std::any_of(scene.colliders.begin(), scene.colliders.end(), moving) ||
         std::any_of(scene.cloths.begin(), scene.cloths.end(), [&](const scene::Cloth& cloth) {
           return std::any_of(cloth.pins.begin(), cloth.pins.end(), moving);
         });
}

/// The largest extent of a cloth's rest shape along an axis [m].
double size_of(const model::Model& model, const model::ClothRange& cloth) {
  scene::dvec3 low(std::numeric_limits<double>::max()), high(-low);
  for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
    low = glm::min(low, model.rest_position[i]);
    high = glm::max(high, model.rest_position[i]);
  }
  const scene::dvec3 extent = high - low;
  return std::max({extent.x, extent.y, extent.z});
}

}  // namespace

void Rest::follow(const scene::Scene& scene, const model::Model& model) {
  disturb();
  driven_ = is_driven(scene.keys.empty() ? scene : scene::at_time(scene, scene::last_change(scene)));
  keyed_until_ = scene::last_change(scene);
  double smallest = std::numeric_limits<double>::max(), largest = 0;
  for (const model::ClothRange& cloth : model.cloths) {
    smallest = std::min(smallest, size_of(model, cloth));
    largest = std::max(largest, size_of(model, cloth));
  }
  const bool surfaces = scene.collides(scene::ContactKind::surface);
  speed_ = pixels_a_second * pixel * smallest +
           (surfaces ? falls_on_surfaces * glm::length(scene.gravity) * scene.solver.dt : 0.0);
  drift_ = (surfaces ? pixels_on_surfaces : pixels_a_stretch) * pixel * smallest;
  const double half_swing = pi * std::sqrt(diagonal * largest / glm::length(scene.gravity));
  stretch_ = std::clamp(margin * half_swing, shortest_stretch, longest_stretch);
}

void Rest::begin(double time, std::vector<glm::vec3> positions) {
  begun_ = time;
  next_look_ = time + stretch_ / most_looks;
  looks_ = 0;
  then_ = std::move(positions);
}

bool Rest::drifted(const std::vector<glm::vec3>& now) const {
  if (now.size() != then_.size()) return true;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double rounding =
        roundings * std::numeric_limits<float>::epsilon() * static_cast<double>(glm::length(now[i]));
    if (!(static_cast<double>(glm::distance(now[i], then_[i])) <= std::max(drift_, rounding))) return true;
  }
  return false;
}

bool Rest::look(double time, double max_speed, const std::function<std::vector<glm::vec3>()>& positions) {
  if (driven_ || time < keyed_until_) return false;
  if (!(max_speed <= speed_)) {
    disturb();
    return false;
  }
  if (!begun_) {
    begin(time, positions());
    return false;
  }
  if (time < next_look_) return false;
  next_look_ = time + stretch_ / most_looks;
  std::vector<glm::vec3> now = positions();
  if (drifted(now)) {
    begin(time, std::move(now));
    return false;
  }
  return ++looks_ >= least_looks && time - *begun_ >= stretch_;
}

}  // namespace clothlab::session
