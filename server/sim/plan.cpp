#include "server/sim/plan.h"

#include <algorithm>
#include <cstddef>

#include "server/base/text.h"
#include "server/scene/method.h"
#include "server/sim/element_lists.h"

namespace clothlab::sim {

namespace {

bool moves(const scene::Motion& motion) {
  return !std::holds_alternative<std::monostate>(motion);
}

/// The text "meet(kind, first, end) " for each kind of shape that the scene has, for
/// shaders/collide/colliders.glsl.
std::string each_solid(const Plan& plan) {
  std::string list;
  int first = 0;
  for (std::size_t kind = 0; kind < plan.solids.size(); ++kind) {
    const int end = first + plan.solids[kind];
    if (end > first) list += formatted("meet(%d, %d, %d) ", static_cast<int>(kind), first, end);
    first = end;
  }
  return list;
}

}  // namespace

std::vector<scene::Motion> moving_motions(const scene::Scene& scene) {
  std::vector<scene::Motion> found;
  const auto add = [&](const scene::Motion& motion) {
    if (moves(motion) && std::find(found.begin(), found.end(), motion) == found.end())
      found.push_back(motion);
  };
  for (const scene::Cloth& cloth : scene.cloths)
    for (const scene::Pin& pin : cloth.pins) add(pin.motion);
  for (const scene::Collider& collider : scene.colliders) add(collider.motion);
  return found;
}

Plan plan(const scene::Scene& scene) {
  Plan plan;
  plan.method = scene.solver.method;
  for (const scene::Cloth& cloth : scene.cloths) {
    plan.structural |= cloth.material.structural > 0.0;
    plan.shear |= cloth.material.shear > 0.0;
    plan.bend |= cloth.material.bend > 0.0;
    plan.pins |= !cloth.pins.empty();
    plan.strain_limit |= cloth.material.strain_limit.has_value();
  }
  for (const scene::Collider& collider : scene.colliders) ++plan.solids[collider.shape.index()];
  plan.moving = static_cast<int>(moving_motions(scene).size());
  plan.self_collision = scene.self_collision.has_value();
  if (scene::sweeps(plan.method))
    for (plan.most_sweeps = 16; plan.most_sweeps < scene.solver.iterations;) plan.most_sweeps *= 4;
  return plan;
}

gl::Defines step_defines(const Plan& plan) {
  gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                      {"MOTION_COUNT", std::to_string(plan.moving)},
                      {"END_ROW", std::to_string(plan.pose_rows())},
                      {"SOLID_COUNT", std::to_string(plan.solid_count())},
                      {"EACH_SOLID(meet)", each_solid(plan)}};
  for (gl::Defines::value_type& define : law_defines(plan)) defines.push_back(std::move(define));
  if (plan.self_collision) {
    defines.emplace_back("SELF_COLLISION", "1");
    defines.emplace_back("NEIGHBOUR_SLOTS", std::to_string(plan.neighbour_slots));
  }
  return defines;
}

std::vector<Simulation::Part> parts(const Plan& plan) {
  using Kind = Simulation::Part::Kind;
  std::vector<Simulation::Part> list;
  const auto add = [&](Kind kind, const std::string& name, bool runs, const std::string& reason) {
    list.push_back({kind, name, runs ? "" : reason});
  };
  add(Kind::pass, "neighbour_search", plan.self_collision, "self_collision is null");
  add(Kind::pass, scene::name(plan.method), true, "");
  add(Kind::pass, "strain_limit", plan.strain_limit, "no cloth has a strain_limit");
  add(Kind::term, "structural_springs", plan.structural, "their stiffness is 0 in every cloth");
  add(Kind::term, "shear_springs", plan.shear, "their stiffness is 0 in every cloth");
  add(Kind::term, "bend_springs", plan.bend, "their stiffness is 0 in every cloth");
  add(Kind::term, "self_contacts", plan.self_collision, "self_collision is null");
  add(Kind::term, "moving_poses", plan.moving > 0, "no pin and no collider moves");
  for (std::size_t kind = 0; kind < plan.solids.size(); ++kind) {
    const std::string name = scene::shape_names()[kind];
    add(Kind::term, name + "s", plan.solids[kind] > 0, "the scene has no " + name);
  }
  return list;
}

}  // namespace clothlab::sim
