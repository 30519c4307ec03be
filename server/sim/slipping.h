// Solids that a mesh is too coarse for: solids keep vertices out, not the triangles between them.
#pragma once

#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::sim {

/// A warning to the user, with what would hold, if a sphere or capsule of the scene fits between the vertices
/// of a cloth's triangle at rest, or an edge of a box may go deep into one; empty if none does.
std::string slipping_warning(const scene::Scene& scene, const model::Model& model);

}  // namespace clothlab::sim
