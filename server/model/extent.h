// How large the cloths of a scene are: what errors of places are a share of.
#pragma once

#include "server/model/model.h"

namespace clothlab::model {

/// The largest extent of a cloth at rest, along an axis [m].
double largest_extent(const Model& model);

}  // namespace clothlab::model
