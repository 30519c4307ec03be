#include "server/mesh/panel.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

#include "server/base/text.h"
#include "server/mesh/planar_triangulation.h"

namespace clothlab::mesh {

namespace {

using Ring = std::vector<dvec2>;

/// Corners that turn by more stay vertices [degrees].
constexpr double sharp = 30.0;
constexpr int rounds_of_smoothing = 12;

double distance_to(const dvec2& p, const dvec2& a, const dvec2& b) {
  const dvec2 along = b - a;
  const double share = glm::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::distance(p, a + share * along);
}

/// Whether two segments meet, also in an end.
bool meet(const dvec2& a, const dvec2& b, const dvec2& c, const dvec2& d) {
  const double abc = doubled_area(a, b, c), abd = doubled_area(a, b, d), cda = doubled_area(c, d, a),
               cdb = doubled_area(c, d, b);
  if (((abc > 0.0) != (abd > 0.0) || abc == 0.0 || abd == 0.0) &&
      ((cda > 0.0) != (cdb > 0.0) || cda == 0.0 || cdb == 0.0) && (abc != 0.0 || abd != 0.0))
    return true;
  const double near = 1e-9 * (glm::distance(a, b) + glm::distance(c, d));
  return distance_to(a, c, d) <= near || distance_to(b, c, d) <= near || distance_to(c, a, b) <= near ||
         distance_to(d, a, b) <= near;
}

bool within(const dvec2& p, const Ring& ring) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if ((ring[i].y > p.y) != (ring[j].y > p.y) &&
        p.x < ring[i].x + (p.y - ring[i].y) / (ring[j].y - ring[i].y) * (ring[j].x - ring[i].x))
      inside = !inside;
  return inside;
}

std::string name_of(std::size_t ring) {
  return ring == 0 ? "the outline" : "hole " + std::to_string(ring - 1);
}

/// The first two sides that meet, of one ring or two, but for neighbours in their common corner.
std::optional<PanelFault> crossing(const std::vector<Ring>& rings) {
  for (std::size_t one = 0; one < rings.size(); ++one)
    for (std::size_t i = 0; i < rings[one].size(); ++i) {
      const Ring& ring = rings[one];
      const dvec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      for (std::size_t other = one; other < rings.size(); ++other) {
        const Ring& beside = rings[other];
        for (std::size_t k = other == one ? i + 1 : 0; k < beside.size(); ++k) {
          const dvec2 &c = beside[k], &d = beside[(k + 1) % beside.size()];
          const bool next = one == other && k == i + 1, last = one == other && (k + 1) % beside.size() == i;
          const bool back = (next && doubled_area(a, b, d) == 0.0 && glm::dot(b - a, d - c) < 0.0) ||
                            (last && doubled_area(a, b, c) == 0.0 && glm::dot(b - a, d - c) < 0.0);
          if (next || last ? !back : !meet(a, b, c, d)) continue;
          return PanelFault{one, i,
                            "the side from corner " + std::to_string(i) + " of " + name_of(one) +
                                " on meets that from corner " + std::to_string(k) + " of " + name_of(other) +
                                " on",
                            "an outline and holes that meet neither themselves nor each other"};
        }
      }
    }
  return std::nullopt;
}

std::optional<PanelFault> fault_of(const Panel& panel) {
  std::size_t corners = 0;
  for (std::size_t k = 0; k < panel.rings.size(); ++k) {
    const Ring& ring = panel.rings[k];
    corners += ring.size();
    if (corners > max_panel_corners)
      return PanelFault{k, 0, std::to_string(corners) + " corners of outline and holes so far",
                        "at most " + std::to_string(max_panel_corners)};
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (!(glm::distance(ring[i], ring[(i + 1) % ring.size()]) > 1e-6))
        return PanelFault{k, i, "the place of the next corner", "corners that are more than 1e-6 m apart"};
  }
  if (auto fault = crossing(panel.rings)) return fault;
  for (std::size_t k = 1; k < panel.rings.size(); ++k) {
    const dvec2& corner = panel.rings[k][0];
    if (!within(corner, panel.rings[0]))
      return PanelFault{k, 0, "a hole outside of the outline", "holes within the outline"};
    for (std::size_t other = 1; other < panel.rings.size(); ++other)
      if (other != k && within(corner, panel.rings[other]))
        return PanelFault{k, 0, "a hole within " + name_of(other), "holes beside each other"};
  }
  return std::nullopt;
}

/// The corners of a ring that stay vertices.
std::vector<std::size_t> kept_corners(const Panel& panel, std::size_t number) {
  const Ring& ring = panel.rings[number];
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const dvec2 before = ring[i] - ring[(i + ring.size() - 1) % ring.size()],
                after = ring[(i + 1) % ring.size()] - ring[i];
    const double cosine = glm::dot(before, after) / (glm::length(before) * glm::length(after));
    const bool end =
        number == 0 && std::any_of(panel.runs.begin(), panel.runs.end(),
                                   [&](const PanelRun& run) { return run.from == i || run.to == i; });
    if (end || cosine < std::cos(glm::radians(sharp))) kept.push_back(i);
  }
  if (kept.empty()) kept.push_back(0);
  return kept;
}

/// A ring with its vertices, and the vertex at each corner that is kept.
struct Spaced {
  Ring vertices;
  std::vector<std::uint32_t> vertex_at;  ///< [corners]
};

Spaced spaced(const Panel& panel, std::size_t number) {
  const Ring& ring = panel.rings[number];
  const std::vector<std::size_t> kept = kept_corners(panel, number);
  Spaced result{{}, std::vector<std::uint32_t>(ring.size(), 0)};
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::size_t begin = kept[k], end = k + 1 < kept.size() ? kept[k + 1] : kept[0] + ring.size();
    double length = 0.0;
    for (std::size_t i = begin; i < end; ++i)
      length += glm::distance(ring[i % ring.size()], ring[(i + 1) % ring.size()]);
    const auto least = kept.size() == 1 ? 3.0 : kept.size() == 2 ? 2.0 : 1.0;
    const auto parts = static_cast<std::size_t>(std::max(least, std::round(length / panel.edge)));
    result.vertex_at[begin] = static_cast<std::uint32_t>(result.vertices.size());
    std::size_t side = begin;
    double before = 0.0;
    for (std::size_t part = 0; part < parts; ++part) {
      const double at = length * static_cast<double>(part) / static_cast<double>(parts);
      double own = glm::distance(ring[side % ring.size()], ring[(side + 1) % ring.size()]);
      while (side + 1 < end && before + own <= at) {
        before += own;
        ++side;
        own = glm::distance(ring[side % ring.size()], ring[(side + 1) % ring.size()]);
      }
      const dvec2 &a = ring[side % ring.size()], &b = ring[(side + 1) % ring.size()];
      result.vertices.push_back(a + (at - before) / own * (b - a));
    }
  }
  return result;
}

/// Corners of equal triangles within the outline, not too near it. Their rows and columns fit the panel's
/// extent.
std::vector<dvec2> lattice(const std::vector<Ring>& rings, double edge, const dvec2& low, const dvec2& high) {
  constexpr double from_outline = 0.62;
  const dvec2 extent = high - low;
  const double rows = std::max(1.0, std::round(extent.y / (std::sqrt(0.75) * edge))),
               columns = std::max(1.0, std::round(extent.x / edge));
  std::vector<dvec2> result;
  for (double row = 1; row < rows; ++row)
    for (double column = std::fmod(row, 2.0) == 0.0 ? 1.0 : 0.5; column < columns; ++column) {
      const dvec2 point = low + extent * dvec2(column / columns, row / rows);
      bool inside = false, far = true;
      for (const Ring& ring : rings) {
        inside = inside != within(point, ring);
        for (std::size_t i = 0; far && i < ring.size(); ++i)
          far = distance_to(point, ring[i], ring[(i + 1) % ring.size()]) >= from_outline * edge;
      }
      if (inside && far) result.push_back(point);
    }
  return result;
}

double area_of(const Ring& ring) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += doubled_area(ring[0], ring[i], ring[i + 1]);
  return 0.5 * std::abs(sum);
}

/// Vertices that a mesh of this edge has, but for a few.
double expected_vertices(const Panel& panel) {
  double count = area_of(panel.rings[0]) / (std::sqrt(0.75) * panel.edge * panel.edge);
  for (const Ring& ring : panel.rings)
    for (std::size_t i = 0; i < ring.size(); ++i)
      count += glm::distance(ring[i], ring[(i + 1) % ring.size()]) / panel.edge;
  return count;
}

/// Of each vertex of the rings with all of them, and of each corner of a lattice over the panel's extent [m].
double comparisons(const std::vector<Ring>& rings, double edge, const dvec2& extent) {
  double around = 0.0;
  for (const Ring& ring : rings) around += static_cast<double>(ring.size());
  return around * (around + extent.x * extent.y / (std::sqrt(0.75) * edge * edge));
}
constexpr double most_comparisons = 1e8;  // about a second

PanelFault too_coarse() {
  return {0, 0, "edges so long that the outline crosses itself between them", "a shorter edge", true};
}

}  // namespace

std::optional<PanelFault> mesh_panel(const Panel& panel, PanelMesh& mesh) {
  if (auto fault = fault_of(panel)) return fault;
  if (const double count = expected_vertices(panel); count > static_cast<double>(max_panel_vertices))
    return PanelFault{
        0, 0, formatted("an edge that makes about %.3g vertices", count),
        "a longer edge: a panel has at most " + std::to_string(max_panel_vertices) + " vertices", true};
  std::vector<Ring> rings;
  std::vector<std::uint32_t> vertex_at;
  dvec2 low(1e300), high(-1e300);
  for (std::size_t k = 0; k < panel.rings.size(); ++k) {
    Spaced ring = spaced(panel, k);
    if (k == 0) vertex_at = ring.vertex_at;
    for (const dvec2& point : ring.vertices) low = glm::min(low, point), high = glm::max(high, point);
    rings.push_back(std::move(ring.vertices));
  }
  if (const double work = comparisons(rings, panel.edge, high - low); work > most_comparisons)
    return PanelFault{
        0, 0, formatted("an edge that takes %.3g comparisons of the mesh with the outline", work),
        formatted("a longer edge, or a piece that lies along an axis: at most %.3g", most_comparisons), true};
  if (crossing(rings)) return too_coarse();
  PlanarTriangulation triangulation(low, high);
  for (const Ring& ring : rings)
    for (const dvec2& point : ring) triangulation.add(point);
  std::uint32_t first = 0;
  for (const Ring& ring : rings) {
    const auto count = static_cast<std::uint32_t>(ring.size());
    for (std::uint32_t i = 0; i < count; ++i)
      if (!triangulation.require(first + i, first + (i + 1) % count)) return too_coarse();
    first += count;
  }
  for (const dvec2& point : lattice(rings, panel.edge, low, high)) triangulation.add(point);
  triangulation.smooth(rounds_of_smoothing);
  mesh.vertices = triangulation.points();
  mesh.triangles = triangulation.inside();
  for (auto& corners : mesh.triangles) std::swap(corners[1], corners[2]);
  const auto around = static_cast<std::uint32_t>(rings[0].size());
  for (const PanelRun& run : panel.runs) {
    std::vector<std::uint32_t> vertices{vertex_at[run.from]};
    while (vertices.back() != vertex_at[run.to]) vertices.push_back((vertices.back() + 1) % around);
    mesh.runs.push_back(std::move(vertices));
  }
  return std::nullopt;
}

}  // namespace clothlab::mesh
