// How thick self-collision must be for a mesh. It keeps vertices apart, so a layer of cloth passes through
// another where a vertex finds a place that is far enough from all others.
#pragma once

#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// The farthest that a point of a triangle can be from the nearest of its corners: the circumradius, less
/// where an angle is obtuse. [m]
double covering_radius(const dvec3& a, const dvec3& b, const dvec3& c);

/// The least self_collision.thickness [m] that leaves no triangle at rest a gap: the largest covering radius
/// and a fifth. Of a square grid 0.85 of the spacing. 0 without triangles.
double thickness_that_holds(const Model& model);

/// What to tell about a self-collision that is thinner than that, in a sentence; empty where it holds or
/// there is none.
std::string thickness_warning(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
