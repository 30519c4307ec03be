#include "server/sim/plan.h"

#include <algorithm>
#include <cstddef>

#include "server/base/text.h"
#include "server/model/size.h"
#include "server/scene/method.h"

namespace clothlab::sim {

namespace {

std::vector<SolidRun> solid_runs(const scene::Scene& scene) {
  std::vector<SolidRun> runs;
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind)
    for (const scene::Collider& collider : scene.colliders) {
      if (collider.shape.index() != kind) continue;
      const SolidRun next{kind, scene::has_motion(collider.motion)};
      if (runs.empty() || runs.back().kind != kind || runs.back().moves != next.moves) runs.push_back(next);
      ++runs.back().count;
    }
  return runs;
}

int rows_of(const SolidRun& run) {
  return run.count * elements::solid_rows(static_cast<int>(run.kind));
}

int solid_rows(const Plan& plan) {
  return std::accumulate(plan.solids.begin(), plan.solids.end(), 0,
                         [](int sum, const SolidRun& run) { return sum + rows_of(run); });
}

/// The text "meet(kind, moves, first, end) " for the rows of each run of solids, for
/// shaders/collide/colliders.glsl.
std::string each_solid(const Plan& plan) {
  std::string list;
  int first = 0;
  for (const SolidRun& run : plan.solids) {
    const int end = first + rows_of(run);
    list += formatted("meet(%zu, %s, %d, %d) ", run.kind, run.moves ? "true" : "false", first, end);
    first = end;
  }
  return list;
}

/// Whether the distance that cloths keep from solids may be another for each (sim::contact_margin): with the
/// thickness of self-collision only from boxes that move among surfaces.
bool margins_differ(const scene::Scene& scene) {
  if (scene.cloths.size() < 2) return false;
  const auto differs = [&](const scene::Collider& collider) {
    if (collider.is_body()) return false;
    return !scene.self_collision ||
           (scene.collides(scene::ContactKind::surface) && scene::has_motion(collider.motion) &&
            std::holds_alternative<scene::Box>(collider.shape));
  };
  return std::any_of(scene.colliders.begin(), scene.colliders.end(), differs);
}

}  // namespace

std::vector<scene::Motion> moving_motions(const scene::Scene& scene) {
  std::vector<scene::Motion> found;
  const auto add = [&](const scene::Motion& motion) {
    if (scene::has_motion(motion) && std::find(found.begin(), found.end(), motion) == found.end())
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
  const model::Size size = model::size_of(scene);
  for (std::size_t law = 0; law < plan.laws.size(); ++law) plan.laws[law] = size.elements[law] > 0;
  const bool springs = plan.laws[elements::law_number<elements::Spring>];
  for (const scene::Cloth& cloth : scene.cloths) {
    if (const auto* material = std::get_if<scene::Springs>(&cloth.material)) {
      plan.structural |= material->structural > 0.0;
      plan.shear |= material->shear > 0.0;
      plan.bend |= material->bend > 0.0;
      plan.limits_springs |= springs && material->strain_limit.has_value();
    } else {
      plan.limits_sheets |= cloth.strain_limit().has_value();
    }
    plan.pins |= !cloth.pins.empty();
  }
  plan.solids = solid_runs(scene);
  plan.bodies = static_cast<int>(std::count_if(scene.colliders.begin(), scene.colliders.end(),
                                               [](const auto& collider) { return collider.is_body(); }));
  if (margins_differ(scene)) plan.cloths_apart = static_cast<int>(scene.cloths.size());
  plan.moving = static_cast<int>(moving_motions(scene).size());
  plan.self_collision = scene.collides(scene::ContactKind::points);
  plan.surfaces = scene.collides(scene::ContactKind::surface);
  plan.wind = scene.wind.has_value();
  if (scene::sweeps(plan.method))
    for (plan.most_sweeps = 16; plan.most_sweeps < scene.solver.iterations;) plan.most_sweeps *= 4;
  return plan;
}

gl::Defines step_defines(const Plan& plan) {
  gl::Defines defines{{"GROUP_SIZE", std::to_string(group_size)},
                      {"MOTION_COUNT", std::to_string(plan.moving)},
                      {"END_ROW", std::to_string(plan.pose_rows())},
                      {"SOLID_ROWS", std::to_string(solid_rows(plan))},
                      {"EACH_SOLID(meet)", each_solid(plan)}};
  for (gl::Defines::value_type& define : law_defines(plan.laws)) defines.push_back(std::move(define));
  if (plan.wind) defines.emplace_back("WIND", "1");
  if (plan.cloths_apart > 0) {
    defines.emplace_back("CLOTHS_APART", std::to_string(plan.cloths_apart));
    if (plan.surfaces) defines.emplace_back("APART_FROM_MOVING_BOXES", "1");
  }
  if (plan.pins && plan.surface_contact()) defines.emplace_back("PINS_WAIT", "1");
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
  const char* const no_points =
      plan.surfaces ? "self_collision is of the kind surface" : "self_collision is null";
  const char* const no_surfaces = plan.self_collision
                                      ? "self_collision is of the kind points, and no collider is a mesh"
                                      : "self_collision is null, and no collider is a mesh";
  add(Kind::pass, "neighbour_search", plan.self_collision, no_points);
  add(Kind::pass, "pair_search", plan.surface_contact(), no_surfaces);
  add(Kind::pass, scene::name(plan.method), true, "");
  add(Kind::pass, "strain_limit", plan.strain_limit(), "no cloth has a strain_limit");
  add(Kind::pass, "surface_contact", plan.surface_contact(), no_surfaces);
  const char* const no_springs = "no cloth has the model springs and this stiffness above 0";
  add(Kind::term, "structural_springs", plan.structural, no_springs);
  add(Kind::term, "shear_springs", plan.shear, no_springs);
  add(Kind::term, "bend_springs", plan.bend, no_springs);
  add(Kind::term, "membrane", plan.laws[elements::law_number<elements::Membrane>],
      "no cloth has the model fem");
  add(Kind::term, "bending", plan.laws[elements::law_number<elements::Bending>],
      "no cloth has the model fem and a bending stiffness above 0");
  add(Kind::term, "rest_curvature", plan.laws[elements::law_number<elements::Shell>],
      "no cloth that bends under the model fem is curved at rest");
  add(Kind::term, "self_contacts", plan.self_collision, no_points);
  add(Kind::term, "wind", plan.wind, "wind is null");
  add(Kind::term, "moving_poses", plan.moving > 0, "no pin and no collider moves");
  add(Kind::term, "meshes", plan.bodies > 0, "the scene has no mesh among its colliders");
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind) {
    const std::string name = scene::shape_names()[kind], names = name + (name.back() == 'x' ? "es" : "s");
    const bool any = std::any_of(plan.solids.begin(), plan.solids.end(),
                                 [&](const auto& run) { return run.kind == kind; });
    add(Kind::term, names, any, "the scene has no " + name);
  }
  return list;
}

}  // namespace clothlab::sim
