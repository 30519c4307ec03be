// Finds out how much of a simulation a change of scene replaces, by comparing the two scenes before anything
// is changed.
#include <algorithm>
#include <variant>

#include "server/sim/plan.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

namespace {

/// True if `to` has a pin that `from` lacks. A new pin would tear its vertices back to their rest positions
/// at once, so it starts the cloth anew; a pin that is removed only lets its vertices fall. A pin with a
/// place takes its vertex there, which a hand has usually done before (hands.h), and the cloth goes on.
bool pins_were_added(const scene::Cloth& from, const scene::Cloth& to) {
  return std::any_of(to.pins.begin(), to.pins.end(), [&](const scene::Pin& pin) {
    return !std::holds_alternative<scene::Placed>(pin.motion) &&
           std::none_of(from.pins.begin(), from.pins.end(),
                        [&](const scene::Pin& old) { return old.at == pin.at; });
  });
}

bool new_cloth(const scene::Cloth& from, const scene::Cloth& to) {
  return from.mesh != to.mesh || from.transform != to.transform || from.start != to.start ||
         pins_were_added(from, to);
}

/// True if `to` has a body that `from` lacks, or has elsewhere. Cloth may be where it comes, and contact only
/// keeps apart what is apart: so it starts the cloth anew. One that is removed only lets the cloth fall.
bool bodies_came(const scene::Scene& from, const scene::Scene& to) {
  return std::any_of(to.colliders.begin(), to.colliders.end(), [&](const scene::Collider& body) {
    return body.is_body() &&
           std::none_of(from.colliders.begin(), from.colliders.end(), [&](const scene::Collider& old) {
             return old.motion == body.motion && old.shape == body.shape;
           });
  });
}

/// The kinds of elements that a material has: springs of three kinds, or a sheet that bends or does not.
std::array<bool, 5> kinds(const scene::Material& material) {
  if (const auto* springs = std::get_if<scene::Springs>(&material))
    return {springs->structural > 0, springs->shear > 0, springs->bend > 0};
  const scene::Fem::Bending& bending = std::get<scene::Fem>(material).bending;
  return {false, false, false, true, bending.warp > 0 || bending.weft > 0 || bending.twist.value_or(0) > 0};
}

/// True if both cloths have the same kinds of elements and number of pins, and either both or neither has a
/// strain limit: then the same kernels and arrays serve both.
bool same_structure(const scene::Cloth& from, const scene::Cloth& to) {
  return kinds(from.material) == kinds(to.material) && from.pins.size() == to.pins.size() &&
         from.strain_limit().has_value() == to.strain_limit().has_value();
}

/// The scene without names, colours and textures, which the simulation does not use.
scene::Scene without_looks(scene::Scene scene) {
  scene.name.clear();
  for (scene::Cloth& cloth : scene.cloths) {
    cloth.name.clear();
    cloth.color.clear();
    cloth.texture.clear();
  }
  for (scene::Collider& collider : scene.colliders) collider.name.clear();
  return scene;
}

/// True if cloth is led out of what is there at its start, and that is other than before.
bool led_out_otherwise(const scene::Scene& from, const scene::Scene& to) {
  const bool asked = std::any_of(to.cloths.begin(), to.cloths.end(), [](const scene::Cloth& cloth) {
    return std::holds_alternative<scene::Dress>(cloth.start);
  });
  return asked && (from.colliders != to.colliders || from.self_collision != to.self_collision);
}

}  // namespace

const char* name(ChangeDepth depth) {
  switch (depth) {
    case ChangeDepth::none:
      return "none";
    case ChangeDepth::uniform:
      return "uniform";
    case ChangeDepth::kernel:
      return "kernel";
    case ChangeDepth::cloth:
      return "cloth";
  }
  return "";
}

ChangeDepth change_depth(const scene::Scene& from, const scene::Scene& to) {
  if (without_looks(from) == without_looks(to)) return ChangeDepth::none;
  if (from.cloths.size() != to.cloths.size() || bodies_came(from, to) || led_out_otherwise(from, to))
    return ChangeDepth::cloth;
  bool same = plan(from) == plan(to);
  for (std::size_t i = 0; i < from.cloths.size(); ++i) {
    if (new_cloth(from.cloths[i], to.cloths[i])) return ChangeDepth::cloth;
    same = same && same_structure(from.cloths[i], to.cloths[i]);
  }
  return same ? ChangeDepth::uniform : ChangeDepth::kernel;
}

}  // namespace clothlab::sim
