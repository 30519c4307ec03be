// Hands the scene's colliders to the step kernel (shaders/collide/colliders.glsl), and tells where they are.
#pragma once

#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/motion_table.h"

namespace clothlab::sim {

/// How far from a collider's surface a vertex is kept [m]: half the cloth's thickness where the scene gives
/// one, else a hundredth of the mesh's mean edge, so that rounding never lets a vertex in.
double contact_margin(const scene::Scene& scene, const model::Model& model);

/// Sets the uniforms of `program`, which was compiled for this scene's number of solids of each kind.
void set_colliders(const gl::Program& program, const scene::Scene& scene, const MotionTable& motions,
                   double margin);

/// Where the colliders are at `time` [s].
std::vector<scene::Collider> colliders_at(const scene::Scene& scene, double time);

}  // namespace clothlab::sim
