// The part of a simulation that depends on the scene but not on the state: the passes of a step and the
// arrays that they read. A change of the scene's structure replaces this part as a whole; a change of the
// scene's numbers only updates it.
#pragma once

#include <memory>
#include <optional>

#include "server/scene/keys.h"
#include "server/sim/integrator.h"
#include "server/sim/list_memory.h"
#include "server/sim/strain_limit.h"
#include "server/sim/surface_contact.h"

namespace clothlab::sim {

struct Kernels {
  Plan plan;
  model::Model model;                         ///< its vertices in the order in which they lie in memory
  std::vector<std::uint32_t> places;          ///< of the scene's vertices in `model`; empty: the same
  std::optional<model::Model> as_in_scene{};  ///< `model` in the scene's order, if that is another
  MotionTable motions;
  std::optional<SelfCollision> self_collision;
  gl::TextureBuffer elements, slices;
  gl::TextureBuffer fan_offsets, fans;  ///< the triangles at each vertex, for the wind; else empty
  std::unique_ptr<Integrator> integrator;
  std::optional<StrainLimit> strain_limit;
  std::optional<SurfaceContact> surface_contact;
  std::shared_ptr<ListMemory> list_memory = ListMemory::of_thread();  ///< null: lists are not bounded by it
  MemoryBudget::Reservation longer_lists{};                           ///< of neighbours, than at first

  /// Makes the kernels of `scene`; nothing is carried over from an earlier step.
  static Result<Kernels> create(const scene::Scene& scene);

  /// Places that the state's buffers need behind the cloths' vertices.
  std::uint32_t body_places() const { return surface_contact ? surface_contact->extra_places() : 0; }

  const model::Model& scene_model() const { return as_in_scene ? *as_in_scene : model; }

  /// Takes over the numbers of a scene with the same structure.
  Status update(const scene::Scene& scene);

  /// Takes over what keys have changed of the scene. Not within a step, but between its stages. The element
  /// lists must be bound anew if materials have changed.
  void take_keyed(const scene::Scene& scene, const scene::KeyedScene::Changed& changed);

  /// Names what the method and the strain limit carry from step to step: what a step may change before it is
  /// given up.
  void carry_method(Carrier& carrier);
  /// Names all that passes carry from step to step. `bind_constants` of the simulation must have been called.
  void carry(Carrier& carrier);
  /// Forgets all of it.
  void forget();
  /// To be called when a step has ended, or is given up: it may begin again.
  void end_step();
  void give_up_step();

  /// Brings the neighbour lists up to date. Makes them longer if they have become too short for all pairs, as
  /// far as the limits on their size allow. The scene must have self-collision. The work may stop on its way.
  Work update_lists(const scene::Scene& scene);

  /// Gives each neighbour list `slots` slots. Error: such lists cannot be made, and the present ones stay.
  Status grow(const scene::Scene& scene, std::uint32_t slots);

  Surroundings surroundings(const scene::Scene& scene) const {
    return {scene, model, motions, self_collision ? &*self_collision : nullptr};
  }
};

}  // namespace clothlab::sim
