#include "server/model/looks.h"

#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::model {

std::array<double, 3> linear_colour(const std::string& colour) {
  std::array<double, 3> linear{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    unsigned byte = 0;
    const char* digits = colour.data() + 1 + 2 * channel;
    std::from_chars(digits, digits + 2, byte, 16);
    const double share = byte / 255.0;
    linear[channel] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  }
  return linear;
}

std::vector<glm::vec3> smooth_normals(std::span<const std::array<std::uint32_t, 3>> triangles,
                                      std::span<const glm::vec3> positions) {
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : triangles) {
    const glm::dvec3 origin(positions[a]);
    const glm::dvec3 twice_area =
        glm::cross(glm::dvec3(positions[b]) - origin, glm::dvec3(positions[c]) - origin);
    for (const std::uint32_t corner : {a, b, c}) sums[corner] += twice_area;
  }
  std::vector<glm::vec3> normals;
  normals.reserve(sums.size());
  for (const glm::dvec3& sum : sums) {
    const double size = glm::length(sum);
    normals.emplace_back(size > 0.0 && std::isfinite(size) ? sum / size : glm::dvec3(0.0, 1.0, 0.0));
  }
  return normals;
}

}  // namespace clothlab::model
