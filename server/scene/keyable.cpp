// The table of what can be keyed: numbers that a running simulation takes over without being built anew, and
// whether a pin holds.
#include <algorithm>
#include <functional>

#include "server/scene/keys.h"
#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

using Tokens = std::vector<std::string>;
using Found = Result<Keyed>;

Keyed number(Effect effect, const Range& range, double& of, bool above_zero = false) {
  return {effect, range, above_zero, {&of}};
}

Keyed vector(const Range& range, dvec3& of) {
  Keyed place{Effect::force, range};
  place.vector = &of;
  return place;
}

Error not_there(const std::string& what, const std::string& remedy) {
  return Error{"", what, remedy};
}

const char* const all_keyable =
    "/gravity, /air_drag, /wind/velocity, /wind/gust, /wind/gust_frequency, /wind/drag, /wind/lift, "
    "/self_collision/friction, /colliders/N/friction, /colliders/N/restitution, /cloths/N/pins/N/held, and "
    "structural, shear, bend, damping, warp, weft or bending of /cloths/N/material";

Error unknown() {
  return not_there("", all_keyable);
}

Found of_wind(Scene& scene, const Tokens& at) {
  if (at.size() != 2) return unknown();
  if (!scene.wind)
    return not_there("wind is null",
                     "a scene with wind: set \"wind\" to {\"velocity\": [0, 0, 0]} and key its velocity");
  Wind& wind = *scene.wind;
  if (at[1] == "velocity") return vector(ranges::wind_speed, wind.velocity);
  if (at[1] == "gust") return number(Effect::force, ranges::gust, wind.gust);
  if (at[1] == "gust_frequency") return number(Effect::force, ranges::frequency, wind.gust_frequency);
  if (at[1] == "drag") return number(Effect::force, ranges::air_coefficient, wind.drag);
  if (at[1] == "lift") return number(Effect::force, ranges::air_coefficient, wind.lift);
  return unknown();
}

Found of_self_collision(Scene& scene, const Tokens& at) {
  if (at.size() != 2) return unknown();
  if (!scene.self_collision)
    return not_there("self_collision is null", "a scene with self_collision: set its thickness first");
  if (at[1] == "friction") return number(Effect::contact, ranges::friction, scene.self_collision->friction);
  if (at[1] == "thickness" || at[1] == "kind")
    return not_there("what lists of neighbours are made for", "/self_collision/friction");
  return unknown();
}

Found of_collider(Scene& scene, const Tokens& at) {
  const auto index = at.size() > 1 ? array_index(at[1], scene.colliders.size()) : std::nullopt;
  if (!index)
    return not_there("no collider with this number", "0 to the number of colliders less 1: there are " +
                                                         std::to_string(scene.colliders.size()));
  Collider& collider = scene.colliders[*index];
  if (at.size() == 3 && at[2] == "friction")
    return number(Effect::contact, ranges::friction, collider.friction);
  if (at.size() == 3 && at[2] == "restitution")
    return number(Effect::contact, ranges::restitution, collider.restitution);
  return not_there("where a collider is, and its shape, by which cloth would be inside it at once",
                   "its friction or restitution; it moves by its motion");
}

Error of_other_model(const char* model) {
  return not_there(std::string("a cloth whose material has the model ") + model,
                   model == std::string("fem") ? "warp, weft, shear, bending or damping of it"
                                               : "structural, shear, bend or damping of it");
}

/// A stiffness of springs, or of bending, which the scene has.
Found stiffness(const Range& range, double& of) {
  if (!(of > 0.0))
    return not_there("a stiffness of 0, which has no elements",
                     "a scene in which it is above 0: then it can be keyed");
  return number(Effect::material, range, of, true);
}

Found of_springs(Springs& springs, const Tokens& at) {
  if (at.size() != 4) return of_other_model("springs");
  if (at[3] == "structural") return stiffness(ranges::stiffness, springs.structural);
  if (at[3] == "shear") return stiffness(ranges::stiffness, springs.shear);
  if (at[3] == "bend") return stiffness(ranges::stiffness, springs.bend);
  if (at[3] == "damping") return number(Effect::material, ranges::damping, springs.damping);
  return of_other_model("springs");
}

Found of_bending(Fem::Bending& bending, const Tokens& at) {
  if (at.size() != 4 || bending.warp != bending.weft || bending.twist)
    return not_there("bending that differs with the direction, on which depends what vertices bend together",
                     "\"bending\" as one number, and a key of that");
  Found alike = stiffness(ranges::bending, bending.warp);
  if (alike) alike->numbers.push_back(&bending.weft);
  return alike;
}

Found of_sheet(Fem& sheet, const Tokens& at) {
  if (at[3] == "bending" && at.size() <= 5) return of_bending(sheet.bending, at);
  if (at.size() != 4) return of_other_model("fem");
  if (at[3] == "warp") return number(Effect::material, ranges::modulus, sheet.warp);
  if (at[3] == "weft") return number(Effect::material, ranges::modulus, sheet.weft);
  if (at[3] == "shear") return number(Effect::material, ranges::shear_modulus, sheet.shear);
  if (at[3] == "damping") return number(Effect::material, ranges::damping_time, sheet.damping);
  return of_other_model("fem");
}

Found of_pin(std::vector<Pin>& pins, const Tokens& at) {
  const auto index = at.size() > 3 ? array_index(at[3], pins.size()) : std::nullopt;
  if (!index)
    return not_there("no pin with this number",
                     "0 to the number of pins less 1: the cloth has " + std::to_string(pins.size()));
  if (at.size() != 5 || at[4] != "held")
    return not_there("what a pin is at, or how it moves", "its held; a pin moves by its motion");
  Keyed place{Effect::hold, {0, 1}};
  place.held = &pins[*index].held;
  return place;
}

Found of_cloth(Scene& scene, const Tokens& at) {
  const auto index = at.size() > 1 ? array_index(at[1], scene.cloths.size()) : std::nullopt;
  if (!index)
    return not_there("no cloth with this number",
                     "0 to the number of cloths less 1: there are " + std::to_string(scene.cloths.size()));
  Cloth& cloth = scene.cloths[*index];
  if (at.size() > 3 && at[2] == "material") {
    if (auto* springs = std::get_if<Springs>(&cloth.material)) return of_springs(*springs, at);
    return of_sheet(std::get<Fem>(cloth.material), at);
  }
  if (at.size() > 2 && at[2] == "pins") return of_pin(cloth.pins, at);
  if (at.size() > 2 && (at[2] == "mass" || at[2] == "weights"))
    return not_there("what vertices weigh, which their momentum belongs to",
                     "/gravity, by which the weight changes");
  return not_there("what a cloth is made of, and begins with",
                   "numbers of its material, or held of its pins");
}

}  // namespace

Result<Keyed> keyed(Scene& scene, const std::string& pointer) {
  const std::optional<Tokens> tokens = split_pointer(pointer);
  if (!tokens || tokens->empty()) return unknown();
  const Tokens& at = *tokens;
  if (pointer == "/gravity") return vector(ranges::gravity, scene.gravity);
  if (pointer == "/air_drag") return number(Effect::force, ranges::air_drag, scene.air_drag);
  if (at[0] == "wind") return of_wind(scene, at);
  if (at[0] == "self_collision") return of_self_collision(scene, at);
  if (at[0] == "colliders") return of_collider(scene, at);
  if (at[0] == "cloths") return of_cloth(scene, at);
  if (at[0] == "solver")
    return not_there("how steps are taken, on which their times depend", "one solver for the whole run");
  return unknown();
}

}  // namespace clothlab::scene
