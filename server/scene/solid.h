// The shapes of colliders, for code that does not depend on their kind: name, numbers for the contact code,
// and place after a motion. solid.cpp defines these for each kind, and does not compile if a kind lacks any.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <variant>

#include "server/scene/scene.h"

namespace clothlab::scene {

inline constexpr std::size_t shape_kinds = std::variant_size_v<Shape>;
/// The kinds that are solids: the first ones of Shape.
inline constexpr std::size_t solid_kinds = shape_kinds - 1;

/// The names of the kinds in a document, in the order of Shape.
const std::array<const char*, shape_kinds>& shape_names();

/// The numbers of a shape that its contact code needs (shaders/elements/solid.glsl). A kind that has no use
/// for one of them leaves it 0.
struct Solid {
  int kind = 0;          ///< the index of the kind in Shape
  dvec3 point{0.0};      ///< [m]
  dvec3 direction{0.0};  ///< unit length, turns with the shape: a plane's normal, a body's first axis
  double radius = 0;     ///< [m]
  dvec3 second{0.0};     ///< a body's second axis, unit length; the third is their cross product
  dvec3 extent{0.0};     ///< half of the edges of a body's core, along its axes [m]
};
/// To be called of solids only.
Solid solid(const Shape& shape);

/// A ball that contains the whole shape.
struct Ball {
  dvec3 center{0.0};  ///< [m]
  double radius = 0;  ///< [m]; infinite if the shape is infinite
};
Ball bounds(const Shape& shape);

/// The shape turned by `rotation`, then moved by `translation` [m].
Shape moved_shape(const Shape& home, const glm::dmat3& rotation, const dvec3& translation);

/// The shape as a document has it: {"sphere": {"center": [x, y, z], "radius": r}}. Of a body only its
/// transform, which is all that a motion changes: {"transform": {...}}.
nlohmann::json shape_to_json(const Shape& shape);

}  // namespace clothlab::scene
