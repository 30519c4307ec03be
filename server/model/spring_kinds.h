// Of which kind each spring of a model is, as a grid's material tells kinds apart.
#pragma once

#include <vector>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// [spring_count] in the order of `model.springs()`, whose vertices are numbered as in `scene`. Of a triangle
/// mesh the springs along edges are structural, those across edges bend: none is for shear alone.
std::vector<SpringKind> spring_kinds(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
