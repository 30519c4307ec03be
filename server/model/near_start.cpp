#include "server/model/near_start.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "server/base/text.h"
#include "server/model/bodies.h"
#include "server/model/clean_start.h"
#include "server/model/near_parts.h"
#include "shaders/elements/elements.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// The gap that the filter needs for a pair: its plane stays `rounding_at` away from both parts
/// (shaders/surface/surface.glsl), and a hundredth more (elements::dividing_plane).
double needed(const dvec3& at, double size) {
  const double farthest = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
  return 2.0 * 1.01 * (2.5e-7 * farthest + 1e-6 * size);
}

struct Near {
  std::size_t pairs = 0;
  double gap = 0, needs = 0;
  double lacks = -1;  ///< of the pair that lacks the most
  std::array<Index, 4> corners{};
};

/// Of the gap that the filter needs, pairs that lack a part.
Near find_near(const Surfaces& surfaces, const std::vector<dvec3>& x) {
  Near found;
  const auto reach = [](const Bounds& box) {
    return needed(glm::max(glm::abs(box.low), glm::abs(box.high)), glm::distance(box.low, box.high));
  };
  each_near_pair(surfaces, x, reach, [&](bool edges, const std::array<Index, 4>& corners) {
    elements::Corners places;
    double size = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      places.x[k] = x[corners[k]] - x[corners[0]];
      size = std::max(size, glm::length(places.x[k]));
    }
    const double gap = elements::separation(edges, places).gap, needs = needed(x[corners[0]], size);
    if (!(gap < needs)) return true;
    ++found.pairs;
    if (needs - gap <= found.lacks) return true;
    found.lacks = needs - gap;
    found.gap = gap;
    found.needs = needs;
    found.corners = corners;
    return true;
  });
  return found;
}

}  // namespace

std::string near_start_warning(const Model& model, const scene::Scene& scene) {
  const bool among_cloths = scene.collides(scene::ContactKind::surface);
  if (!among_cloths && model.bodies.empty()) return {};
  std::vector<dvec3> x;
  for (const dvec3& place : model.start_position) x.emplace_back(glm::vec3(place));
  for (const dvec3& place : body_positions(model, 0.0)) x.emplace_back(glm::vec3(place));
  Surfaces surfaces = surfaces_of(model, Bodies::meshes);  // boxes push cloth out that starts in them
  surfaces.among_cloths = among_cloths;
  const Near near = find_near(surfaces, x);
  if (near.pairs == 0) return {};
  return formatted(
      "at the start %s is %.2g m from %s, nearer than the %.2g m that contact between surfaces can tell "
      "from touching there, in 32-bit floats (%zu such %s): it holds both where they are, pins too, and "
      "counts them as forced; move them apart by %.2g m or more (transform, start)",
      place_in_words(near.corners.front(), model, scene).c_str(), near.gap,
      place_in_words(near.corners.back(), model, scene).c_str(), near.needs, near.pairs,
      near.pairs == 1 ? "pair" : "pairs", near.lacks);
}

}  // namespace clothlab::model
