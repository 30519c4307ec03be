// Where vertices lie in memory: neighbours near each other, so that a step finds them in the cache.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// [vertex_count] for each vertex its place in memory, or nothing if all stay where they are: in scenes that
/// fit the cache anyway, in grids, and in meshes whose neighbours are near already. Depends on the triangles
/// alone.
std::vector<std::uint32_t> near_places(const Model& model, const scene::Scene& scene);

/// The same model with each vertex at its place. Triangles keep their order.
Model renumbered(const Model& model, const std::vector<std::uint32_t>& places);

}  // namespace clothlab::model
