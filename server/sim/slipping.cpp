#include "server/sim/slipping.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <variant>
#include <vector>

#include "server/base/text.h"
#include "server/model/bodies.h"
#include "server/model/thickness.h"
#include "server/sim/colliders.h"

namespace clothlab::sim {

namespace {

/// What of a cloth's triangles at rest lets solids in.
struct Openings {
  double covering = 0.0;  ///< the largest distance from a point of one to its nearest corner [m]
  double edge = 0.0;      ///< the longest edge [m]
  double width = 0.0;     ///< of the cloth, along the axis where it is widest [m]
};

std::vector<Openings> openings_of(const model::Model& model) {
  std::vector<Openings> found(model.cloths.size());
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<glm::dvec3> low(found.size(), glm::dvec3(infinite)), high(found.size(), glm::dvec3(-infinite));
  for (const auto& [a, b, c] : model.triangles) {
    const std::uint32_t cloth = model.vertex_cloth[a];
    const glm::dvec3 &x = model.rest_position[a], &y = model.rest_position[b], &z = model.rest_position[c];
    Openings& of = found[cloth];
    of.covering = std::max(of.covering, model::covering_radius(x, y, z));
    of.edge = std::max({of.edge, glm::distance(x, y), glm::distance(y, z), glm::distance(z, x)});
    low[cloth] = glm::min(low[cloth], glm::min(x, glm::min(y, z)));
    high[cloth] = glm::max(high[cloth], glm::max(x, glm::max(y, z)));
    const glm::dvec3 size = high[cloth] - low[cloth];
    of.width = std::max(size.x, std::max(size.y, size.z));
  }
  return found;
}

/// A box's edge is told from this depth on, as a share of the cloth's width: less is hardly seen.
constexpr double deep = 0.02;

}  // namespace

std::string slipping_warning(const scene::Scene& scene, const model::Model& model) {
  const std::vector<Openings> openings = openings_of(model);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i) {
    const scene::Collider& collider = scene.colliders[i];
    const auto* sphere = std::get_if<scene::Sphere>(&collider.shape);
    const auto* capsule = std::get_if<scene::Capsule>(&collider.shape);
    const bool round = sphere || capsule, box = std::holds_alternative<scene::Box>(collider.shape);
    const double radius = sphere ? sphere->radius : capsule ? capsule->radius : 0.0;
    for (std::uint32_t cloth = 0; cloth < openings.size(); ++cloth) {
      const Openings& of = openings[cloth];
      const double margin = contact_margin(scene, model, cloth, collider);
      if (round && radius + margin < of.covering)
        return formatted(
            "/colliders/%zu: a radius of %.3g m fits between the vertices of the triangles of /cloths/%u, "
            "and may "
            "go through them: solids keep vertices out. What holds: a radius of %.3g m, a mesh %.2g times as "
            "fine, "
            "or a \"mesh\" of triangles as collider",
            i, radius, cloth, of.covering - margin, of.covering / (radius + margin));
      // An edge of length l between two vertices at the margin goes l / sqrt(8) into a right angle, less the
      // margin.
      const double depth = of.edge / std::sqrt(8.0) - margin;
      if (box && !model::has_edges(scene, collider) && depth > deep * of.width)
        return formatted(
            "/colliders/%zu: the edges and corners of this box may go %.2g m into the triangles of "
            "/cloths/%u: solids "
            "keep vertices out. What holds: a mesh %.2g times as fine, %sor a \"mesh\" of triangles as "
            "collider",
            i, depth, cloth, of.edge / std::sqrt(8.0) / (margin + deep * of.width),
            collider.motion == scene::Motion{} ? "self_collision of the kind \"surface\", " : "");
    }
  }
  return {};
}

}  // namespace clothlab::sim
