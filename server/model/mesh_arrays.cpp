#include "server/model/mesh_arrays.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "server/model/sheet_springs.h"

namespace clothlab::model {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge sorted(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// A triangle at an edge: its third vertex, and where in the triangle the edge begins.
struct AtEdge {
  std::uint32_t opposite = 0, triangle = 0;
  std::size_t corner = 0;
};

/// Lengths in the flat pattern of a mesh.
class Pattern {
 public:
  explicit Pattern(const scene::TriangleMesh& mesh) : mesh_(mesh) {}

  /// Of an edge. On a seam each panel has its own length; the mean is between them.
  double edge(const std::vector<AtEdge>& at) const {
    if (mesh_.pattern.empty()) return 0.0;
    double sum = 0.0;
    for (const AtEdge& side : at) sum += unfolded(side).length;
    return sum / static_cast<double>(at.size());
  }

  /// Between the two vertices opposite an edge, if the triangles lie flat beside each other there.
  double across(const AtEdge& one, const AtEdge& other) const {
    if (mesh_.pattern.empty()) return 0.0;
    const Unfolded a = unfolded(one), b = unfolded(other);
    return std::hypot(a.along - b.along, a.height + b.height);
  }

 private:
  struct Unfolded {
    double length;         ///< of the edge
    double along, height;  ///< the third corner: along the edge from its lower vertex, and beside it
  };
  Unfolded unfolded(const AtEdge& side) const {
    const auto& corners = mesh_.triangles[side.triangle];
    const auto& places = mesh_.pattern[side.triangle];
    const std::size_t next = (side.corner + 1) % 3;
    const bool forward = corners[side.corner] < corners[next];
    const glm::dvec2 from = places[forward ? side.corner : next], to = places[forward ? next : side.corner];
    const double length = glm::distance(from, to);
    const glm::dvec2 direction = (to - from) / length, third = places[(side.corner + 2) % 3] - from;
    return {length, glm::dot(third, direction), std::abs(direction.x * third.y - direction.y * third.x)};
  }

  const scene::TriangleMesh& mesh_;
};

void connect_grid(MeshArrays& arrays, const scene::Grid& grid, const scene::Springs& springs) {
  const int columns = grid.columns, rows = grid.rows;
  const auto index = [&](int column, int row) { return static_cast<std::uint32_t>(row * columns + column); };
  arrays.springs.reserve(6 * arrays.position.size());
  const auto connect = [&](double stiffness, int columns_on, int rows_on) {
    if (stiffness == 0.0) return;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const int to_column = column + columns_on, to_row = row + rows_on;
        if (to_column < 0 || to_column >= columns || to_row >= rows) continue;
        const auto [a, b] = sorted(index(column, row), index(to_column, to_row));
        arrays.springs.push_back({a, b, stiffness, springs.damping});
      }
    }
  };
  connect(springs.structural, 1, 0);
  connect(springs.structural, 0, 1);
  connect(springs.shear, 1, 1);
  connect(springs.shear, -1, 1);
  connect(springs.bend, 2, 0);
  connect(springs.bend, 0, 2);
}

/// What a grid with these springs is as a sheet, on the average over all directions.
struct GridMean {
  SpringSheet sheet;
  double damping_time;  ///< its viscosity over its stiffness [s]
};

/// Springs two away count four times, as they are stretched twice as far, and diagonals twice, as they resist
/// shear too: a square grid's tensions over strains are (structural + shear + 4 bend) along the threads, and
/// shear between them and against shear.
GridMean mean_of(const scene::Springs& springs) {
  const double whole = springs.structural + 2.0 * springs.shear + 4.0 * springs.bend;
  const double viscous =
      springs.damping * ((springs.structural > 0.0 ? 1.0 : 0.0) + (springs.shear > 0.0 ? 2.0 : 0.0) +
                         (springs.bend > 0.0 ? 4.0 : 0.0));
  return {{whole / 4.0, springs.bend}, viscous / whole};
}

/// Edges in rising order, then the pairs of vertices that are opposite an edge, in rising order.
struct Pairs {
  std::vector<SheetPair> pairs;
  std::vector<double> rest;  ///< [pair_count] as in MeshSpring
};

Pairs pairs_of(const scene::TriangleMesh& mesh) {
  const Pattern pattern(mesh);
  std::map<Edge, std::vector<AtEdge>> edges;  // edge -> the triangles on it
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& triangle = mesh.triangles[i];
    for (std::size_t corner = 0; corner < 3; ++corner)
      edges[sorted(triangle[corner], triangle[(corner + 1) % 3])].push_back(
          {triangle[(corner + 2) % 3], i, corner});
  }
  const auto area = [&](const AtEdge& at) {
    const auto& [a, b, c] = mesh.triangles[at.triangle];
    const dvec3 &from = mesh.vertices[a], u = mesh.vertices[b] - from, v = mesh.vertices[c] - from;
    return 0.5 * glm::length(glm::cross(u, v));
  };
  const auto is_longest = [&](const AtEdge& at) {
    const auto& corners = mesh.triangles[at.triangle];
    const auto length = [&](std::size_t from) {
      return glm::distance(mesh.vertices[corners[from % 3]], mesh.vertices[corners[(from + 1) % 3]]);
    };
    const double own = (1.0 + 1e-6) * length(at.corner);
    return own >= length(at.corner + 1) && own >= length(at.corner + 2);
  };
  Pairs result;
  struct Across {
    double area;
    bool diagonal;
    double rest;
  };
  std::map<Edge, Across> across;  // two edges may have the same pair
  for (const auto& [edge, at] : edges) {
    double third = 0.0;
    for (const AtEdge& side : at) third += area(side) / 3.0;
    result.pairs.push_back({edge.first, edge.second, false, third, false});
    result.rest.push_back(pattern.edge(at));
    if (at.size() != 2 || at[0].opposite == at[1].opposite) continue;
    const Edge pair = sorted(at[0].opposite, at[1].opposite);
    const bool diagonal = is_longest(at[0]) && is_longest(at[1]);
    if (!edges.contains(pair))
      across.try_emplace(pair, Across{third, diagonal, pattern.across(at[0], at[1])});
  }
  for (const auto& [pair, of] : across) {
    result.pairs.push_back({pair.first, pair.second, true, of.area, of.diagonal});
    result.rest.push_back(of.rest);
  }
  return result;
}

void connect_triangles(MeshArrays& arrays, const scene::TriangleMesh& mesh, const scene::Springs& springs) {
  const auto [sheet, damping_time] = mean_of(springs);
  if (!(sheet.modulus > 0.0)) return;
  const auto [pairs, rest] = pairs_of(mesh);
  const std::vector<double> stiffness = sheet_stiffness(mesh.vertices, mesh.triangles, pairs, sheet);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    // Across an edge of triangles without area there is nothing to hold.
    const double least = springs.bend == 0.0 ? 1e-3 * sheet.modulus : 0.0;
    const bool needless = pairs[i].across && stiffness[i] <= least;
    if (!needless)
      arrays.springs.push_back({pairs[i].a, pairs[i].b, stiffness[i], damping_time * stiffness[i], rest[i]});
  }
}

}  // namespace

MeshArrays grid_arrays(const scene::Grid& grid, const scene::Material& material) {
  MeshArrays arrays;
  const int columns = grid.columns, rows = grid.rows;
  const auto index = [&](int column, int row) { return static_cast<std::uint32_t>(row * columns + column); };

  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double u = static_cast<double>(column) / (columns - 1), v = static_cast<double>(row) / (rows - 1);
      arrays.position.emplace_back((u - 0.5) * grid.width, 0.0, v * grid.height);
      arrays.texture_coordinates.emplace_back(static_cast<float>(u), static_cast<float>(v));
    }
  }
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      arrays.triangles.push_back({index(column, row), index(column, row + 1), index(column + 1, row + 1)});
      arrays.triangles.push_back({index(column, row), index(column + 1, row + 1), index(column + 1, row)});
    }
  }

  if (const auto* springs = std::get_if<scene::Springs>(&material)) connect_grid(arrays, grid, *springs);
  return arrays;
}

MeshArrays triangle_mesh_arrays(const scene::TriangleMesh& mesh, const scene::Material& material) {
  MeshArrays arrays;
  arrays.position = mesh.vertices;
  arrays.triangles = mesh.triangles;

  // Texture coordinates: positions along the two axes in which the mesh is largest, over its largest extent.
  dvec3 low(1e300), high(-1e300);
  for (const dvec3& point : mesh.vertices) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  const dvec3 extent = high - low;
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  const int u = std::min(axes[0], axes[1]), v = std::max(axes[0], axes[1]);
  const double size = std::max(extent[axes[0]], 1e-9);
  arrays.first_axis = arrays.second_axis = dvec3(0.0);
  arrays.first_axis[u] = arrays.second_axis[v] = 1.0;
  for (const dvec3& point : mesh.vertices)
    arrays.texture_coordinates.emplace_back(static_cast<float>((point[u] - low[u]) / size),
                                            static_cast<float>((point[v] - low[v]) / size));

  if (const auto* springs = std::get_if<scene::Springs>(&material)) connect_triangles(arrays, mesh, *springs);
  return arrays;
}

}  // namespace clothlab::model
