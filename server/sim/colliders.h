// Passes the scene's colliders to the step kernels (shaders/collide/colliders.glsl), and finds where they are
// at a given time.
#pragma once

#include <cstdint>
#include <vector>

#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/motion_table.h"

namespace clothlab::sim {

/// The distance at which a cloth's vertices are kept from a collider's surface [m]: half of self-collision's
/// thickness if the scene has one, else a hundredth of the cloth's mean edge, so that rounding never lets a
/// vertex in. `cloth`: its place in the scene's list.
double contact_margin(const scene::Scene& scene, const model::Model& model, std::uint32_t cloth);

/// The same of one collider. Under the self-collision kind `surface`, whose thickness may be much less than
/// an edge, a box that moves keeps vertices so far away that an edge between two of them does not cut its
/// corners: an edge of length l around a right angle needs l / sqrt(8). Else the cloth would catch on them.
/// (A box at rest keeps its corners and edges apart from the cloth instead: model::has_edges.)
double contact_margin(const scene::Scene& scene, const model::Model& model, std::uint32_t cloth,
                      const scene::Collider& collider);

/// Those of all cloths [cloth_count] [m], and the least of them.
std::vector<double> contact_margins(const scene::Scene& scene, const model::Model& model);
double least_contact_margin(const scene::Scene& scene, const model::Model& model);
double least_contact_margin(const scene::Scene& scene, const model::Model& model,
                            const scene::Collider& collider);

/// Sets the uniforms `solids` and `cloths_apart` of `program`, which must have been compiled for this scene's
/// solids and cloths (Plan::solids, Plan::cloths_apart).
void set_colliders(const gl::Program& program, const scene::Scene& scene, const model::Model& model,
                   const MotionTable& motions);

/// The scene's colliders with their shapes moved to where they are at `time` [s].
std::vector<scene::Collider> colliders_at(const scene::Scene& scene, double time);

}  // namespace clothlab::sim
