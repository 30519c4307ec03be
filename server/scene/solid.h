// What the shapes of colliders are to whoever need not know which one it is: its name, its numbers for the
// law, where a motion takes it. All that differs from kind to kind is in solid.cpp, and a kind that lacks any
// of it does not compile.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <variant>

#include "server/scene/scene.h"

namespace clothlab::scene {

inline constexpr std::size_t shape_kinds = std::variant_size_v<Shape>;

/// "sphere", "plane": what a document calls each kind, in the order of Shape.
const std::array<const char*, shape_kinds>& shape_names();

/// A shape as its law takes it (shaders/elements/solid.glsl).
struct Solid {
  int kind = 0;          ///< its place in Shape
  dvec3 point{0.0};      ///< [m]
  dvec3 direction{0.0};  ///< unit length; 0 where the kind has none
  double radius = 0;     ///< [m]
};
Solid solid(const Shape& shape);

/// A ball that holds a shape.
struct Ball {
  dvec3 center{0.0};
  double radius = 0;  ///< [m]; infinite where the shape has no end
};
Ball bounds(const Shape& shape);

/// The shape turned by `rotation`, then moved by `translation` [m].
Shape placed(const Shape& home, const glm::dmat3& rotation, const dvec3& translation);

/// As in a document: {"sphere": {"center": [x, y, z], "radius": r}}.
nlohmann::json written(const Shape& shape);

}  // namespace clothlab::scene
