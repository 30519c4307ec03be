#include "server/model/shell.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::model {

namespace {

constexpr std::size_t own_corners = 3;

dvec3 value(const std::array<double, CurvatureRows::most_vertices>& row, const CurvatureRows& rows,
            const std::vector<dvec3>& rest) {
  dvec3 sum(0.0);
  // From the first corner: the places' own size must not cost digits.
  for (std::size_t k = 1; k < row.size(); ++k)
    sum += row[k] * (rest[rows.vertices[k]] - rest[rows.vertices[0]]);
  return sum;
}

}  // namespace

std::vector<CurvedTriangle> curved_triangles(std::vector<CurvatureRows> plate,
                                             const std::vector<dvec3>& rest) {
  std::vector<CurvedTriangle> result;
  result.reserve(plate.size());
  for (CurvatureRows& rows : plate) {
    const auto& [a, b, c] = std::array{rows.vertices[0], rows.vertices[1], rows.vertices[2]};
    const dvec3 u = rest[b] - rest[a], v = rest[c] - rest[a], area = glm::cross(u, v);
    const double twice_area = glm::length(area);
    const dvec3 normal = area / twice_area;
    const dvec3 along_u = glm::cross(v, normal) / twice_area, along_v = glm::cross(normal, u) / twice_area;
    CurvedTriangle triangle{rows, {}};
    for (std::size_t i = 0; i < triangle.rows.row.size(); ++i) {
      auto& row = triangle.rows.row[i];
      const dvec3 at_rest = value(row, rows, rest);
      const double first = glm::dot(at_rest, along_u), second = glm::dot(at_rest, along_v);
      row[0] += first + second;
      row[1] -= first;
      row[2] -= second;
      triangle.along_normal[i] = glm::dot(at_rest, normal);
    }
    result.push_back(triangle);
  }
  return result;
}

std::vector<Rise> rises(const std::vector<CurvedTriangle>& triangles, const std::vector<dvec3>& rest) {
  constexpr double rounding = 1e-10;  // share of the largest pull
  std::vector<Rise> result;
  double largest = 0.0;
  for (const auto& [rows, along_normal] : triangles) {
    const std::array triangle{rows.vertices[0], rows.vertices[1], rows.vertices[2]};
    const dvec3& first = rest[triangle[0]];
    const dvec3 area = glm::cross(rest[triangle[1]] - first, rest[triangle[2]] - first);
    const double twice_area = glm::length(area);
    for (std::size_t k = own_corners; k < rows.vertices.size(); ++k) {
      const std::uint32_t vertex = rows.vertices[k];
      double pull = 0.0;
      for (std::size_t i = 0; i < along_normal.size(); ++i) pull += along_normal[i] * rows.row[i][k];
      if (pull == 0.0) continue;
      largest = std::max(largest, std::abs(pull));
      result.push_back(
          {triangle, vertex, pull, glm::dot(area, rest[vertex] - first) / twice_area, twice_area});
    }
  }
  std::erase_if(result, [&](const Rise& rise) { return std::abs(rise.pull) <= rounding * largest; });
  return result;
}

}  // namespace clothlab::model
