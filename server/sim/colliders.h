// Passes the scene's colliders to the step kernels (shaders/collide/colliders.glsl), and finds where they are
// at a given time.
#pragma once

#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/motion_table.h"

namespace clothlab::sim {

/// The distance at which vertices are kept from a collider's surface [m]: half of self-collision's thickness
/// if the scene has one, else a hundredth of the mean edge (of the cloth with the longest), so that rounding
/// never lets a vertex in.
double contact_margin(const scene::Scene& scene, const model::Model& model);

/// The same of one collider. Under the self-collision kind `surface`, whose thickness may be much less than
/// an edge, a box that moves keeps vertices so far away that an edge between two of them does not cut its
/// corners: an edge of length l around a right angle needs l / sqrt(8). Else the cloth would catch on them.
/// (A box at rest keeps its corners and edges apart from the cloth instead: model::has_edges.)
double contact_margin(const scene::Scene& scene, const model::Model& model, const scene::Collider& collider);

/// Sets the uniform `solids` of `program`, which must have been compiled for this scene's solids
/// (Plan::solids).
void set_colliders(const gl::Program& program, const scene::Scene& scene, const model::Model& model,
                   const MotionTable& motions);

/// The scene's colliders with their shapes moved to where they are at `time` [s].
std::vector<scene::Collider> colliders_at(const scene::Scene& scene, double time);

}  // namespace clothlab::sim
