// scene -> particles, elements, triangles, pins as CPU arrays. All cloths of a scene are laid end to end. No
// GL here.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/elements.h"
#include "server/scene/scene.h"

namespace clothlab::model {

enum class SpringKind : std::uint8_t { structural, shear, bend };

/// The stiffness [N/m] that `material` gives springs of this kind.
double stiffness(const scene::Springs& material, SpringKind kind);

/// One cloth's share of the arrays.
struct ClothRange {
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  double mean_edge_length = 0;  ///< [m], over the triangles' edges at rest
};

inline constexpr std::int32_t not_pinned = -1;

/// Everything the simulation needs that does not change while it runs.
struct Model {
  std::vector<dvec3> rest_position;            ///< [vertex_count] [m], transform applied; home of the pins
  std::vector<dvec3> start_position;           ///< [vertex_count] [m] at time 0; most often the same
  std::vector<double> mass;                    ///< [vertex_count] [kg], weights included
  std::vector<std::int32_t> pin_motion;        ///< [vertex_count] not_pinned, or an index into `motions`
  std::vector<scene::Motion> motions;          ///< of the pins
  std::vector<std::uint32_t> vertex_cloth;     ///< [vertex_count]
  std::vector<glm::vec2> texture_coordinates;  ///< [vertex_count], [0, 1] over a grid, [m] / 1 m otherwise
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [triangle_count]
  Batches elements;                                     ///< each element once
  Adjacency vertex_triangles;                           ///< triangles at each vertex
  /// Of each vertex those that self-collision leaves out, in rising order: the other corners of its elements.
  Adjacency contact_exclusions;
  std::vector<ClothRange> cloths;

  const Batch<elements::Spring>& springs() const { return elements.springs; }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(rest_position.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size()); }
};

/// Builds the arrays. Errors name the JSON Pointer: a pin outside its mesh, a triangle index out of range,
/// ...
Result<Model> build(const scene::Scene& scene);

/// For each vertex the two other corners of each of its triangles, counter-clockwise, in the order of
/// `vertex_triangles`: what shaders/stream/normal.glsl reads.
std::vector<std::uint32_t> vertex_fans(const Model& model);

}  // namespace clothlab::model
