// How large a scene is, counted from its numbers alone: before anything of that size exists.
#pragma once

#include <cstddef>

#include "server/base/result.h"
#include "server/model/elements.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Size {
  std::size_t vertices = 0, triangles = 0;
  std::size_t springs = 0;  ///< exact for grids; of a triangle mesh no more than these
  /// Entries in the lists of the elements at each vertex, one for each corner of an element.
  std::size_t entries() const { return elements::corners<elements::Spring> * springs; }
};

Size size_of(const scene::Scene& scene);

/// Error: the scene has more than that, of which, and what helps.
Status within(const Size& size, std::size_t most_vertices, std::size_t most_springs);

}  // namespace clothlab::model
