#include "server/model/rest_lengths.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "server/model/sheet.h"

namespace clothlab::model {

namespace {

struct Side {  // an edge, as one of its triangles has it
  std::uint32_t low, high;
  double length;
  bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
};

}  // namespace

std::vector<float> edge_rest_lengths(const Model& model, const scene::Scene& scene) {
  std::vector<Side> sides;
  sides.reserve(3 * model.triangles.size());
  for (std::size_t cloth = 0; cloth < model.cloths.size(); ++cloth) {
    const ClothRange& range = model.cloths[cloth];
    const std::vector<FlatTriangle>* pattern = pattern_of(scene.cloths[cloth]);
    const double scale = scene.cloths[cloth].transform.scale;
    for (std::uint32_t i = 0; i < range.triangle_count; ++i) {
      const auto& corners = model.triangles[range.first_triangle + i];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const std::uint32_t a = corners[k], b = corners[next];
        const double length = pattern ? scale * glm::distance((*pattern)[i][k], (*pattern)[i][next])
                                      : glm::distance(model.rest_position[a], model.rest_position[b]);
        sides.push_back({std::min(a, b), std::max(a, b), length});
      }
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  std::vector<float> lengths;
  for (auto at = sides.begin(); at != sides.end();) {
    const auto end = std::find_if(at, sides.end(), [&](const Side& each) { return !each.same_edge(*at); });
    double sum = 0;
    for (auto each = at; each != end; ++each) sum += each->length;
    lengths.push_back(static_cast<float>(sum / static_cast<double>(end - at)));
    at = end;
  }
  return lengths;
}

}  // namespace clothlab::model
