#include "server/film/surface.h"

#include <cmath>
#include <numbers>

#include "server/model/looks.h"

namespace clothlab::film {

namespace {

/// Everything within `radius` of a line along x, from -half_length to half_length: circles from one end to
/// the other. The middle one is there twice, once at each end of the line.
Surface round_surface(float radius, float half_length) {
  constexpr std::uint32_t half = 12, sectors = 48;
  constexpr std::uint32_t circles = 2 * half + 2, around = sectors + 1;
  Surface surface;
  for (std::uint32_t circle = 0; circle < circles; ++circle) {
    const bool far = circle > half;
    const float down = std::numbers::pi_v<float> * static_cast<float>(circle - (far ? 1 : 0)) / (2.0f * half);
    const float out = circle == 0 || circle == circles - 1 ? 0.0f : std::sin(down);
    for (std::uint32_t sector = 0; sector < around; ++sector) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(sector % sectors) / sectors;
      const glm::vec3 normal(std::cos(down), out * std::cos(angle), out * std::sin(angle));
      surface.normals.push_back(normal);
      surface.positions.push_back(radius * normal + glm::vec3(far ? -half_length : half_length, 0, 0));
    }
  }
  for (std::uint32_t circle = 0; circle + 1 < circles; ++circle)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = circle * around + sector, b = a + around;
      if (circle + 2 < circles) surface.triangles.push_back({a, b, b + 1});  // the last circle is a point,
      if (circle > 0) surface.triangles.push_back({a, b + 1, a + 1});        // and so is the first
    }
  return surface;
}

/// The six faces of a cuboid from -1 to 1, each with corners of its own.
Surface box_surface() {
  Surface surface;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(surface.positions.size());
      glm::vec3 outwards(0.0f);
      outwards[axis] = side;
      for (const auto& [along, across] :
           {std::array{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
        glm::vec3 corner = outwards;
        corner[(axis + 1) % 3] = side * along;
        corner[(axis + 2) % 3] = across;
        surface.positions.push_back(corner);
        surface.normals.push_back(outwards);
      }
      surface.triangles.push_back({first, first + 1, first + 2});
      surface.triangles.push_back({first, first + 2, first + 3});
    }
  return surface;
}

/// A square that faces up.
Surface square_surface(float half) {
  const glm::vec3 up(0, 1, 0);
  return {{{-half, 0, -half}, {-half, 0, half}, {half, 0, half}, {half, 0, -half}},
          {up, up, up, up},
          {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace

Surface surface_of(const Form& form) {
  const auto radius = static_cast<float>(form.radius), half = static_cast<float>(form.half_length);
  switch (form.kind) {
    case Form::Kind::ball:
      return round_surface(1.0f, 0.0f);
    case Form::Kind::box:
      return box_surface();
    case Form::Kind::capsule:
      return round_surface(radius, half);
    case Form::Kind::square:
      return square_surface(half);
    case Form::Kind::mesh:
      break;
  }
  Surface surface;
  for (const glm::dvec3& vertex : form.mesh->vertices) surface.positions.emplace_back(vertex);
  surface.triangles = form.mesh->triangles;
  surface.normals = model::smooth_normals(surface.triangles, surface.positions);
  return surface;
}

}  // namespace clothlab::film
