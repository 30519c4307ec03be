// What files for other programs say of a surface beside its places: colours in linear light, and normals.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

namespace clothlab::model {

/// A colour "#rrggbb" in linear light, each channel in [0, 1] (IEC 61966-2-1).
std::array<double, 3> linear_colour(const std::string& colour);

/// Normals of smooth shading, by area [vertex_count]; straight up where a vertex has no triangle with an
/// area.
std::vector<glm::vec3> smooth_normals(std::span<const std::array<std::uint32_t, 3>> triangles,
                                      std::span<const glm::vec3> positions);

}  // namespace clothlab::model
