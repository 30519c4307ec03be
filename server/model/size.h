// The size of a scene, computed from the document alone, before any array of that size is allocated.
#pragma once

#include <cstddef>

#include "server/base/result.h"
#include "server/model/elements.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Size {
  std::size_t vertices = 0, triangles = 0;
  std::size_t springs = 0;  ///< exact for grids, an upper bound for triangle meshes
  /// Entries in all vertices' lists of elements together: one for each corner of each element.
  std::size_t entries() const { return elements::corners<elements::Spring> * springs; }
};

Size size_of(const scene::Scene& scene);

/// An error if the scene has more vertices or springs than allowed; it says which, and what helps.
Status check_size(const Size& size, std::size_t most_vertices, std::size_t most_springs);

}  // namespace clothlab::model
