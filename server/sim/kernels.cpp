#include "server/sim/kernels.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "server/base/pieces.h"
#include "server/model/numbering.h"
#include "server/sim/element_lists.h"

namespace clothlab::sim {

namespace {

/// Returns the number of entries.
std::size_t upload_elements(Kernels& kernels) {
  const ElementLists lists = element_lists(kernels.model);
  kernels.elements = {gl::Buffer(lists.entries), GL_RGBA32UI};
  kernels.slices = {gl::Buffer(lists.slices), GL_R32UI};
  return lists.entries.size();
}

MotionTable motion_table(const scene::Scene& scene, const Plan& plan) {
  return MotionTable(moving_motions(scene), scene.wind, plan.pose_rows(), scene.keys);
}

/// CLOTHLAB_NUMBERING=scene in the environment leaves vertices where they are: tests/bench/numbering.mjs
/// measures what that costs.
bool keeps_numbering() {
  const char* numbering = std::getenv("CLOTHLAB_NUMBERING");
  return numbering && std::string_view(numbering) == "scene";
}

/// Takes over a model that is in the scene's order.
void take_model(Kernels& kernels, model::Model model) {
  if (kernels.places.empty()) {
    kernels.model = std::move(model);
    return;
  }
  kernels.model = model::renumbered(model, kernels.places);
  kernels.as_in_scene = std::move(model);
}

}  // namespace

Result<Kernels> Kernels::create(const scene::Scene& scene) {
  Kernels kernels;
  Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  if (!keeps_numbering()) kernels.places = model::near_places(*model, scene);
  take_model(kernels, std::move(*model));
  kernels.plan = sim::plan(scene);
  kernels.motions = motion_table(scene, kernels.plan);
  if (kernels.plan.self_collision) {
    Result<SelfCollision> self_collision = SelfCollision::create(kernels.model);
    if (!self_collision) return self_collision.error();
    kernels.self_collision = std::move(*self_collision);
    if (Status set = kernels.self_collision->set_parameters(*scene.self_collision, kernels.model); !set)
      return set.error();
  }
  const std::size_t entries = upload_elements(kernels);
  if (kernels.plan.wind) {
    kernels.fan_offsets = {gl::Buffer(kernels.model.vertex_triangles.offsets), GL_R32UI};
    kernels.fans = {gl::Buffer(model::vertex_fans(kernels.model)), GL_RG32UI};
  }
  Result<std::unique_ptr<Integrator>> integrator = make_integrator(kernels.surroundings(scene), kernels.plan);
  if (!integrator) return integrator.error();
  kernels.integrator = std::move(*integrator);
  kernels.integrator->restart();
  if (kernels.plan.strain_limit()) {
    Result<StrainLimit> limit = StrainLimit::create(kernels.surroundings(scene), kernels.plan, entries);
    if (!limit) return limit.error();
    kernels.strain_limit = std::move(*limit);
  }
  if (kernels.plan.surface_contact()) {
    Result<SurfaceContact> contact = SurfaceContact::create(kernels.model, kernels.plan);
    if (!contact) return contact.error();
    kernels.surface_contact = std::move(*contact);
    kernels.surface_contact->set_parameters(scene, kernels.model, kernels.motions);
  }
  return kernels;
}

Work Kernels::update_lists(const scene::Scene& scene) {
  co_await self_collision->update_lists();
  const std::uint32_t slots = self_collision->slots_needed();
  if (slots == self_collision->slots()) co_return;
  // If the longer lists cannot be made, the present ones stay in use.
  if (!grow(scene, slots)) co_return;
  co_await self_collision->update_lists();
}

Status Kernels::grow(const scene::Scene& scene, std::uint32_t slots) {
  const std::size_t bytes = std::size_t{slots - std::min(slots, neighbour_slots)} * 8 * model.vertex_count();
  if (list_memory && !list_memory->resize(longer_lists, bytes))
    return Error{"memory", "longer lists of neighbours", "a smaller thickness or a coarser mesh"};
  Plan larger = plan;
  larger.neighbour_slots = slots;
  Result<SelfCollision> grown = SelfCollision::create(model, slots);
  if (!grown) return grown.error();
  Result<std::unique_ptr<Integrator>> adapted = make_integrator(surroundings(scene), larger);
  if (!adapted) return adapted.error();
  if (Status set = grown->set_parameters(*scene.self_collision, model); !set) return set.error();
  grown->take_counters(*self_collision);
  *self_collision = std::move(*grown);
  plan = larger;
  // Longer lists are no reason to forget the last step.
  Carried remembered;
  {
    Carrier out = Carrier::to(remembered);
    integrator->carry(out);
  }
  integrator = std::move(*adapted);
  integrator->set_parameters(surroundings(scene));
  integrator->restart();
  Carrier back = Carrier::from(remembered);
  integrator->carry(back);
  return ok();
}

void Kernels::carry_method(Carrier& carrier) {
  integrator->carry(carrier);
  if (strain_limit) strain_limit->carry(carrier);
}

void Kernels::carry(Carrier& carrier) {
  carry_method(carrier);
  if (self_collision) self_collision->carry(carrier);
  if (surface_contact) surface_contact->carry(carrier);
}

void Kernels::forget() {
  if (self_collision) self_collision->invalidate();
  integrator->restart();
  if (strain_limit) strain_limit->restart();
  if (surface_contact) surface_contact->invalidate();
}

void Kernels::end_step() {
  if (self_collision) self_collision->end_step();
  if (surface_contact) surface_contact->end_step();
}

void Kernels::give_up_step() {
  if (self_collision) self_collision->give_up_step();
}

void Kernels::take_keyed(const scene::Scene& scene, const scene::KeyedScene::Changed& changed) {
  if (changed.materials) {
    const Whole whole;
    // Keys change no elements but their numbers (scene/keyable.cpp), so that this cannot fail.
    (void)model::take_materials(as_in_scene ? *as_in_scene : model, scene);
    if (as_in_scene) model = model::renumbered(*as_in_scene, places);
    upload_elements(*this);
    integrator->set_parameters(surroundings(scene));
  } else {
    integrator->set_numbers(surroundings(scene));
  }
  if (strain_limit) strain_limit->set_parameters(surroundings(scene));
  if (surface_contact) surface_contact->set_numbers(scene, model, motions);
}

Status Kernels::update(const scene::Scene& scene) {
  // Masses and pins are part of the model. To build it again is cheap and cannot change its structure here.
  Result<model::Model> rebuilt = model::build(scene);
  if (!rebuilt) return rebuilt.error();
  const Whole whole;
  if (self_collision)
    if (Status set = self_collision->set_parameters(*scene.self_collision, *rebuilt); !set)
      return set.error();
  const bool new_elements = scene_model().elements != rebuilt->elements;
  take_model(*this, std::move(*rebuilt));
  motions = motion_table(scene, plan);
  if (new_elements) upload_elements(*this);
  integrator->set_parameters(surroundings(scene));
  if (strain_limit) strain_limit->set_parameters(surroundings(scene));
  if (surface_contact) surface_contact->set_parameters(scene, model, motions);
  return ok();
}

}  // namespace clothlab::sim
