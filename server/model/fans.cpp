#include "server/model/model.h"

namespace clothlab::model {

std::vector<std::uint32_t> vertex_fans(const Model& model) {
  std::vector<std::uint32_t> corners;
  corners.reserve(2 * model.vertex_triangles.items.size());
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i) {
    for (std::uint32_t at = model.vertex_triangles.offsets[i]; at < model.vertex_triangles.offsets[i + 1];
         ++at) {
      const auto& triangle = model.triangles[model.vertex_triangles.items[at]];
      const std::size_t corner = triangle[0] == i ? 0 : triangle[1] == i ? 1 : 2;
      corners.push_back(triangle[(corner + 1) % 3]);
      corners.push_back(triangle[(corner + 2) % 3]);
    }
  }
  return corners;
}

}  // namespace clothlab::model
