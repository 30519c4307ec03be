#include "server/model/near_start.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "server/base/pieces.h"
#include "server/base/text.h"
#include "server/model/bodies.h"
#include "server/model/box_tree.h"
#include "server/model/clean_start.h"
#include "server/model/crossings.h"
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

class Search {
 public:
  Search(const Surfaces& surfaces, const std::vector<dvec3>& x) : surfaces_(surfaces), x_(x) {}

  Near run() {
    std::vector<Bounds> boxes;
    for (const auto& [a, b, c] : surfaces_.triangles)
      boxes.push_back({glm::min(x_[a], glm::min(x_[b], x_[c])), glm::max(x_[a], glm::max(x_[b], x_[c]))});
    const BoxTree tree(boxes);
    std::vector<Index> others;
    Pieces pieces;
    for (Index i = 0; i < boxes.size(); ++i) {
      pieces.next();
      const Bounds& box = boxes[i];
      const double reach =
          needed(glm::max(glm::abs(box.low), glm::abs(box.high)), glm::distance(box.low, box.high));
      others.clear();
      tree.overlapping({box.low - reach, box.high + reach}, others);
      for (const Index other : others) look_at(surfaces_.triangles[i], surfaces_.triangles[other]);
    }
    return found_;
  }

 private:
  using Triangle = std::array<Index, 3>;

  void look_at(const Triangle& one, const Triangle& other) {
    const bool body = one[0] >= surfaces_.first_body_vertex,
               other_body = other[0] >= surfaces_.first_body_vertex;
    if ((body && other_body) || (!surfaces_.among_cloths && !body && !other_body)) return;
    for (const Index corner : one)
      if (std::find(other.begin(), other.end(), corner) != other.end()) return;
    for (const Index corner : one) look_at(false, {corner, other[0], other[1], other[2]});
    if (!(one < other)) return;  // two edges once
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        look_at(true, {one[i], one[(i + 1) % 3], other[j], other[(j + 1) % 3]});
  }

  void look_at(bool edges, const std::array<Index, 4>& corners) {
    elements::Corners places;
    double size = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      places.x[k] = x_[corners[k]] - x_[corners[0]];
      size = std::max(size, glm::length(places.x[k]));
    }
    const double gap = elements::separation(edges, places).gap, needs = needed(x_[corners[0]], size);
    if (!(gap < needs)) return;
    ++found_.pairs;
    if (needs - gap <= found_.lacks) return;
    found_.lacks = needs - gap;
    found_.gap = gap;
    found_.needs = needs;
    found_.corners = corners;
  }

  const Surfaces& surfaces_;
  const std::vector<dvec3>& x_;
  Near found_;
};

}  // namespace

std::string near_start_warning(const Model& model, const scene::Scene& scene) {
  const bool among_cloths = scene.collides(scene::ContactKind::surface);
  if (!among_cloths && model.bodies.empty()) return {};
  std::vector<dvec3> x;
  for (const dvec3& place : model.start_position) x.emplace_back(glm::vec3(place));
  for (const dvec3& place : body_positions(model, 0.0)) x.emplace_back(glm::vec3(place));
  Surfaces surfaces = surfaces_of(model, Bodies::meshes);  // boxes push cloth out that starts in them
  surfaces.among_cloths = among_cloths;
  const Near near = Search(surfaces, x).run();
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
