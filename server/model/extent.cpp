#include "server/model/extent.h"

#include <algorithm>
#include <glm/common.hpp>

namespace clothlab::model {

double largest_extent(const Model& model) {
  double most = 0.0;
  for (const ClothRange& cloth : model.cloths) {
    glm::dvec3 low(1e300), high(-1e300);
    for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
      low = glm::min(low, model.rest_position[i]);
      high = glm::max(high, model.rest_position[i]);
    }
    const glm::dvec3 extent = high - low;
    most = std::max({most, extent.x, extent.y, extent.z});
  }
  return most;
}

}  // namespace clothlab::model
