// Values of the scene that keys set over time: which ones can be keyed, and the scene as it is at a time.
// Every part that steps a scene takes it from here, so that all agree on a key's law to the bit.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/ranges.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

/// The value of a key at time t [s].
dvec3 value_at(const Key& key, double t);
/// From this time on a key's value no longer changes [s].
inline double last_change(const Key& key) {
  return key.times.back();
}
/// The last of all keys' times [s]; 0 without keys.
double last_change(const Scene& scene);
/// The times at which a key has a corner or a jump: what integrates over one of them loses its order [s],
/// rising.
std::vector<double> key_times(const Scene& scene);

/// The wind at time t [s], where `keys` has keys of it.
Wind wind_at(Wind wind, const std::vector<Key>& keys, double t);
/// The gravity at time t [s].
dvec3 gravity_at(const Scene& scene, double t);
/// True if the scene has a key of what the pointer names.
bool has_key(const Scene& scene, const std::string& of);

/// What changes with a keyed value.
enum class Effect {
  force,     ///< gravity, drag of the air, wind: numbers of the step's forces
  contact,   ///< friction and restitution: numbers of what happens on the way to the step's end
  material,  ///< elements
  hold       ///< whether a pin holds its vertices
};

/// A place in a scene that can be keyed. The pointers are into that scene.
struct Keyed {
  Effect effect = Effect::force;
  Range range{0, 0};
  bool above_zero = false;         ///< 0 would take elements out of the scene, which a key cannot
  std::vector<double*> numbers{};  ///< all get the same value
  dvec3* vector = nullptr;         ///< instead of numbers
  bool* held = nullptr;            ///< instead of numbers
  void set(const dvec3& value) const;
  /// True if both set the same value, or one sets a part of the other.
  bool overlaps(const Keyed& other) const;
};

/// The place that a JSON Pointer names. Error: none that can be keyed; `where` is empty, `what` says why if
/// the pointer names something of the scene, `remedy` what to take instead.
Result<Keyed> keyed(Scene& scene, const std::string& pointer);

/// A copy of a scene with keys, whose keyed values are those of a time.
class KeyedScene {
 public:
  /// At time 0.
  explicit KeyedScene(const Scene& scene);
  KeyedScene(const KeyedScene& other) : KeyedScene(other.scene_) {}
  KeyedScene& operator=(const KeyedScene&) = delete;

  const Scene& scene() const { return scene_; }
  /// The solver is no matter of keys.
  void set_solver(const Solver& solver) { scene_.solver = solver; }

  struct Changed {
    bool forces = false, contacts = false, materials = false, holds = false;
    bool any() const { return forces || contacts || materials || holds; }
  };
  /// Sets forces and materials to their values at one time [s], contacts to those at another. Says what is
  /// another value than before.
  Changed set(double forces, double contacts);
  /// Lets go of the pins whose keys say so at time t [s]. A pin that has let go stays so.
  Changed let_go(double t);
  /// True if `let_go` would change any.
  bool lets_go(double t) const;
  /// Pins hold again whose keys say at time t [s] that they do. True if that changes any.
  bool hold_again(double t);

  /// Pins that have let go, by cloth and place.
  struct LetGo {
    std::size_t cloth = 0;
    At at;
    bool operator==(const LetGo&) const = default;
  };
  std::vector<LetGo> released() const;
  /// These have let go, of the pins that the scene has, and no others. True if that changes any.
  bool release(const std::vector<LetGo>& released);

 private:
  bool set_value(std::size_t key, double t);

  Scene scene_;
  std::vector<Keyed> places_;  ///< of each key, in scene_
  std::vector<dvec3> values_;
};

/// Takes all that keys can set from a scene of the same structure.
void take_keyed(const Scene& from, Scene& to);

/// The scene as keys make it at time t [s], all pins held.
Scene at_time(const Scene& scene, double t);
/// The scene with every keyed number at its largest.
Scene at_largest(const Scene& scene);
/// The largest of a keyed stiffness over its smallest, of the key for which that is most; 1 without such
/// keys.
double stiffness_growth(const Scene& scene);
/// The scenes with keyed values at their extremes that decide how long a step may be: every number at its
/// largest; and, where damping is keyed, the same with damping at its smallest. Only the scene itself where
/// it has no keys of what matters to that.
std::vector<Scene> extremes(const Scene& scene);

}  // namespace clothlab::scene
