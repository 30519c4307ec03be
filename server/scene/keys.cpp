#include "server/scene/keys.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::scene {

namespace {

/// A step's time is a product of its number, rounded: a keyframe counts from a step at its own time on, even
/// where rounding makes that step's time a little less.
double but_for_rounding(double t) {
  return t + 1e-12 * std::abs(t);
}

bool is_damping(const Key& key) {
  return key.of == "/air_drag" || key.of.ends_with("/damping");
}

bool decides_steps(const Key& key) {
  return is_damping(key) || key.of.starts_with("/cloths/");
}

bool is_stiffness(const Key& key) {
  return key.of.starts_with("/cloths/") && !is_damping(key) && !key.of.ends_with("/held");
}

double size(const dvec3& value) {
  return glm::dot(value, value);
}

/// The value of a key that is the largest, or the smallest.
const dvec3& extreme(const Key& key, bool largest) {
  const auto less = [](const dvec3& a, const dvec3& b) { return size(a) < size(b); };
  return largest ? *std::max_element(key.values.begin(), key.values.end(), less)
                 : *std::min_element(key.values.begin(), key.values.end(), less);
}

/// Keyed numbers at their largest, damping at its smallest unless `most_damped`. Pins that let go have: a
/// free vertex vibrates faster than a held one lets its neighbours.
Scene at_extreme(const Scene& scene, bool most_damped) {
  Scene result = scene;
  for (const Key& key : scene.keys) {
    const Result<Keyed> place = keyed(result, key.of);
    if (!place) continue;
    const bool largest = place->effect != Effect::hold && (most_damped || !is_damping(key));
    place->set(extreme(key, largest));
  }
  return result;
}

}  // namespace

dvec3 value_at(const Key& key, double t) {
  const auto later = std::upper_bound(key.times.begin(), key.times.end(), but_for_rounding(t));
  if (later == key.times.begin()) return key.values.front();
  if (later == key.times.end()) return key.values.back();
  const auto next = static_cast<std::size_t>(later - key.times.begin()), last = next - 1;
  if (key.ease == Ease::step) return key.values[last];
  double share = std::clamp((t - key.times[last]) / (key.times[next] - key.times[last]), 0.0, 1.0);
  if (key.ease == Ease::smooth) share = share * share * (3.0 - 2.0 * share);
  return key.values[last] + share * (key.values[next] - key.values[last]);
}

double last_change(const Scene& scene) {
  double last = 0.0;
  for (const Key& key : scene.keys) last = std::max(last, last_change(key));
  return last;
}

std::vector<double> key_times(const Scene& scene) {
  std::vector<double> times;
  for (const Key& key : scene.keys) times.insert(times.end(), key.times.begin(), key.times.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

Wind wind_at(Wind wind, const std::vector<Key>& keys, double t) {
  for (const Key& key : keys) {
    if (key.of == "/wind/velocity") wind.velocity = value_at(key, t);
    if (key.of == "/wind/gust") wind.gust = value_at(key, t).x;
    if (key.of == "/wind/gust_frequency") wind.gust_frequency = value_at(key, t).x;
    if (key.of == "/wind/drag") wind.drag = value_at(key, t).x;
    if (key.of == "/wind/lift") wind.lift = value_at(key, t).x;
  }
  return wind;
}

dvec3 gravity_at(const Scene& scene, double t) {
  for (const Key& key : scene.keys)
    if (key.of == "/gravity") return value_at(key, t);
  return scene.gravity;
}

bool has_key(const Scene& scene, const std::string& of) {
  return std::any_of(scene.keys.begin(), scene.keys.end(), [&](const Key& key) { return key.of == of; });
}

void Keyed::set(const dvec3& value) const {
  for (double* number : numbers) *number = value.x;
  if (vector) *vector = value;
  if (held) *held = value.x != 0.0;
}

bool Keyed::overlaps(const Keyed& other) const {
  if ((vector && vector == other.vector) || (held && held == other.held)) return true;
  return std::any_of(numbers.begin(), numbers.end(), [&](const double* number) {
    return std::find(other.numbers.begin(), other.numbers.end(), number) != other.numbers.end();
  });
}

KeyedScene::KeyedScene(const Scene& scene) : scene_(scene) {
  for (const Key& key : scene_.keys) {
    const Result<Keyed> place = keyed(scene_, key.of);
    places_.push_back(place ? *place : Keyed{});
    values_.push_back(value_at(key, 0.0));
    if (places_.back().effect != Effect::hold) places_.back().set(values_.back());
  }
}

bool KeyedScene::set_value(std::size_t key, double t) {
  const dvec3 value = value_at(scene_.keys[key], t);
  if (value == values_[key]) return false;
  values_[key] = value;
  places_[key].set(value);
  return true;
}

KeyedScene::Changed KeyedScene::set(double forces, double contacts) {
  Changed changed;
  for (std::size_t key = 0; key < places_.size(); ++key) switch (places_[key].effect) {
      case Effect::force:
        changed.forces |= set_value(key, forces);
        break;
      case Effect::material:
        changed.materials |= set_value(key, forces);
        break;
      case Effect::contact:
        changed.contacts |= set_value(key, contacts);
        break;
      case Effect::hold:
        break;
    }
  return changed;
}

KeyedScene::Changed KeyedScene::let_go(double t) {
  Changed changed;
  for (std::size_t key = 0; key < places_.size(); ++key) {
    const Keyed& pin = places_[key];
    if (pin.effect != Effect::hold || !*pin.held || value_at(scene_.keys[key], t).x != 0.0) continue;
    *pin.held = false;
    changed.holds = true;
  }
  return changed;
}

bool KeyedScene::lets_go(double t) const {
  for (std::size_t key = 0; key < places_.size(); ++key)
    if (places_[key].effect == Effect::hold && *places_[key].held && value_at(scene_.keys[key], t).x == 0.0)
      return true;
  return false;
}

bool KeyedScene::hold_again(double t) {
  bool changed = false;
  for (std::size_t key = 0; key < places_.size(); ++key) {
    const Keyed& pin = places_[key];
    if (pin.effect != Effect::hold || *pin.held || value_at(scene_.keys[key], t).x == 0.0) continue;
    changed = *pin.held = true;
  }
  return changed;
}

std::vector<KeyedScene::LetGo> KeyedScene::released() const {
  std::vector<LetGo> list;
  for (std::size_t i = 0; i < scene_.cloths.size(); ++i)
    for (const Pin& pin : scene_.cloths[i].pins)
      if (!pin.held) list.push_back({i, pin.at});
  return list;
}

bool KeyedScene::release(const std::vector<LetGo>& released) {
  bool changed = false;
  for (std::size_t i = 0; i < scene_.cloths.size(); ++i)
    for (Pin& pin : scene_.cloths[i].pins) {
      const bool held = std::find(released.begin(), released.end(), LetGo{i, pin.at}) == released.end();
      changed |= held != pin.held;
      pin.held = held;
    }
  return changed;
}

void take_keyed(const Scene& from, Scene& to) {
  to.gravity = from.gravity;
  to.air_drag = from.air_drag;
  to.wind = from.wind;
  to.self_collision = from.self_collision;
  for (std::size_t i = 0; i < to.colliders.size(); ++i) {
    to.colliders[i].friction = from.colliders[i].friction;
    to.colliders[i].restitution = from.colliders[i].restitution;
  }
  for (std::size_t i = 0; i < to.cloths.size(); ++i) {
    to.cloths[i].material = from.cloths[i].material;
    to.cloths[i].pins = from.cloths[i].pins;
  }
}

Scene at_time(const Scene& scene, double t) {
  KeyedScene keyed(scene);
  keyed.set(t, t);
  return keyed.scene();
}

Scene at_largest(const Scene& scene) {
  return at_extreme(scene, true);
}

double stiffness_growth(const Scene& scene) {
  double growth = 1.0;
  for (const Key& key : scene.keys)
    if (is_stiffness(key))
      growth = std::max(growth, extreme(key, true).x / std::max(extreme(key, false).x, 1e-300));
  return growth;
}

std::vector<Scene> extremes(const Scene& scene) {
  const std::vector<Key>& keys = scene.keys;
  if (std::none_of(keys.begin(), keys.end(), decides_steps)) return {scene};
  std::vector<Scene> list{at_extreme(scene, true)};
  if (std::any_of(keys.begin(), keys.end(), is_damping)) list.push_back(at_extreme(scene, false));
  return list;
}

}  // namespace clothlab::scene
