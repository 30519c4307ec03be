// The lists of a model that say what is at each vertex. Internal to model/.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// Makes the lists of a model whose vertices, triangles and elements are there: the elements and triangles at
/// each vertex and, if there are `contacts`, the pairs that self-collision ignores.
void list_neighbours(Model& model, bool contacts);

}  // namespace clothlab::model
