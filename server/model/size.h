// The size of a scene, computed from the document alone, before any array of that size is allocated.
#pragma once

#include <array>
#include <cstddef>
#include <numeric>

#include "server/base/result.h"
#include "server/model/elements.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Size {
  std::size_t vertices = 0, triangles = 0;
  /// Of each law, in the order of elements::Laws: exact for grids, upper bounds for triangle meshes.
  std::array<std::size_t, elements::law_count> elements{};

  /// All laws' elements together.
  std::size_t all_elements() const {
    return std::accumulate(elements.begin(), elements.end(), std::size_t{0});
  }
  /// Texels of all vertices' lists of elements together: an entry for each corner of each element.
  std::size_t list_texels() const;
};

Size size_of(const scene::Scene& scene);

/// An error if the scene has more vertices or springs than allowed; it says which, and what helps.
Status check_size(const Size& size, std::size_t most_vertices, std::size_t most_springs);

}  // namespace clothlab::model
