#include "server/lab/measure/first_touch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "server/model/bodies.h"
#include "server/model/clean_start.h"
#include "server/model/near_parts.h"
#include "server/sim/surface_pairs.h"
#include "shaders/elements/elements.h"

namespace clothlab::lab {

namespace {

/// Places on the way between two looks at which parts are compared, at most: enough for 100 m/s, a 128th of a
/// second and 3 mm of thickness.
constexpr double most_parts = 512;

double gap(bool edges, const std::array<std::uint32_t, 4>& corners, const std::vector<glm::dvec3>& x) {
  elements::Corners places;
  for (std::size_t k = 0; k < 4; ++k) places.x[k] = x[corners[k]] - x[corners[0]];
  return elements::separation(edges, places).gap;
}

std::vector<glm::dvec3> with_bodies(const model::Model& model, std::vector<glm::dvec3> x, double time) {
  const std::vector<glm::dvec3> bodies = model::body_positions(model, time);
  x.insert(x.end(), bodies.begin(), bodies.end());
  return x;
}

}  // namespace

FirstTouch::FirstTouch(const scene::Scene& scene, const model::Model& model)
    : scene_(scene), model_(model), surfaces_(model::surfaces_of(model, model::Bodies::meshes)) {
  surfaces_.among_cloths = scene.collides(scene::ContactKind::surface);
  if (surfaces_.among_cloths || !model.bodies.empty())
    thickness_ = sim::SurfacePairs::thickness(scene, model);
  last_ = with_bodies(model, model.start_position, 0.0);
}

bool FirstTouch::of_one_cloth(const std::array<std::uint32_t, 4>& corners) const {
  return std::any_of(model_.cloths.begin(), model_.cloths.end(), [&](const model::ClothRange& cloth) {
    return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
      return corner >= cloth.first_vertex && corner < cloth.first_vertex + cloth.vertex_count;
    });
  });
}

std::string FirstTouch::near_pair(const Places& x, double farther) const {
  std::string found;
  model::each_near_pair(
      surfaces_, x, [&](const model::Bounds&) { return thickness_ + farther; },
      [&](bool edges, const std::array<std::uint32_t, 4>& corners) {
        double keep = thickness_;
        // Neighbours within a cloth press from half of their distance at rest on (shaders/surface:
        // radius_of).
        if (of_one_cloth(corners)) keep = std::min(keep, 0.5 * gap(edges, corners, model_.rest_position));
        if (!(gap(edges, corners, x) < keep + farther)) return true;
        found = model::place_in_words(corners.front(), model_, scene_) + " and " +
                model::place_in_words(corners.back(), model_, scene_);
        return false;
      });
  return found;
}

std::string FirstTouch::look(const std::vector<glm::dvec3>& position, double time) {
  if (thickness_ == 0.0) return {};
  const Places last = std::exchange(last_, with_bodies(model_, position, time));
  double farthest = 0.0;
  for (std::size_t i = 0; i < last.size(); ++i)
    farthest = std::max(farthest, glm::distance(last[i], last_[i]));
  // Two parts come at most twice as much nearer as a vertex goes.
  if (near_pair(last_, 2.0 * farthest).empty()) return {};
  const int parts = static_cast<int>(std::clamp(std::ceil(2.0 * farthest / thickness_), 1.0, most_parts));
  for (int part = 1; part <= parts; ++part) {
    Places x = last;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = glm::mix(last[i], last_[i], static_cast<double>(part) / parts);
    if (std::string found = near_pair(x, 0.0); !found.empty()) return found;
  }
  return {};
}

}  // namespace clothlab::lab
