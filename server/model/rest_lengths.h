// The lengths at rest of a mesh's edges, by which a viewer can tell how far the cloth is stretched.
#pragma once

#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// For each edge of a triangle of the cloths, once, in the order of its lower vertex, then of its higher one:
/// its length at rest [m], in the flat pattern of a cloth that has one.
std::vector<float> edge_rest_lengths(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
