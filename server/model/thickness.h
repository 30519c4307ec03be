// The least thickness of self-collision that works for a mesh. Self-collision keeps only vertices apart: a
// layer of cloth passes through another where a vertex finds a point far enough from all other vertices.
#pragma once

#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// The largest distance [m] from a point of a triangle to the nearest of its corners: the circumradius, or
/// less where an angle is obtuse.
double covering_radius(const dvec3& a, const dvec3& b, const dvec3& c);

/// The mean edge of the cloth with the shortest ones, at rest [m]; 0 without cloths.
double least_mean_edge(const Model& model);

/// The least self_collision.thickness [m] with which no vertex slips through a triangle at rest: 1.2 times
/// the largest covering radius. On a square grid that is 0.85 of the spacing. 0 without triangles.
double least_safe_thickness(const Model& model);

/// A warning to the user if the scene's self-collision is thinner than least_safe_thickness; empty if it is
/// not, or if the scene has no self-collision.
std::string thickness_warning(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
