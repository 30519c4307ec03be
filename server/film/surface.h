// The surface of a body's form as triangles, for formats that have no spheres or boxes.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "server/film/bodies.h"

namespace clothlab::film {

/// Of bodies, in linear light; as in pictures (shaders/render/body.frag).
inline constexpr std::array<double, 3> bodies_colour{0.42, 0.47, 0.52};

struct Surface {
  std::vector<glm::vec3> positions, normals;            ///< [vertex_count]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise, seen from outside
};

Surface surface_of(const Form& form);

}  // namespace clothlab::film
