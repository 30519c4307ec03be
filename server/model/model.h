// Builds the model of a scene: particles, elements, triangles and pins as CPU arrays. Each array holds all
// cloths one after another. No GL here.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/elements.h"
#include "server/scene/scene.h"

namespace clothlab::model {

enum class SpringKind : std::uint8_t { structural, shear, bend };

/// The stiffness [N/m] that `material` gives springs of this kind.
double stiffness(const scene::Springs& material, SpringKind kind);

/// The part of the model's arrays that belongs to one cloth.
struct ClothRange {
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  double mean_edge_length = 0;  ///< at rest, over the edges of all triangles [m]
};

/// A collider that is a body of triangles, or a box whose edges meet those of cloth (has_edges), and its part
/// of the arrays of all bodies.
struct BodyRange {
  std::uint32_t collider = 0;                            ///< its place in the scene's list
  std::uint32_t first_vertex = 0, vertex_count = 0;      ///< of body_position
  std::uint32_t first_triangle = 0, triangle_count = 0;  ///< of body_triangles
  scene::Motion motion;
  bool box = false;
};

inline constexpr std::int32_t not_pinned = -1;

/// What leading cloth out at the start did ("start": {"dress": seconds}).
struct Dressed {
  std::uint32_t vertices = 0;  ///< that moved
  double farthest = 0;         ///< of them [m]
  double seconds = 0;          ///< of leading out until nothing crossed, or all there were [s]
  bool done = false;           ///< nothing crosses
};

/// Everything the simulation needs that does not change while it runs.
struct Model {
  std::vector<dvec3> rest_position;            ///< [vertex_count] [m], after the transform; pins move from it
  std::vector<dvec3> start_position;           ///< [vertex_count] [m] at time 0; see start.h
  std::vector<double> mass;                    ///< [vertex_count] [kg], weights included
  std::vector<std::int32_t> pin_motion;        ///< [vertex_count] not_pinned, or an index into `motions`
  std::vector<scene::Motion> motions;          ///< the motions of the pins, each once
  std::vector<std::uint32_t> vertex_cloth;     ///< [vertex_count] index of the vertex's cloth
  std::vector<glm::vec2> texture_coordinates;  ///< [vertex_count], each in [0, 1]; see mesh_arrays.h
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [triangle_count]
  Batches elements;                                     ///< all elements, each once
  Adjacency vertex_triangles;                           ///< for each vertex its triangles
  /// For each vertex the other corners of its elements, in rising order: self-collision ignores these pairs.
  /// Empty in a scene without self-collision.
  Adjacency contact_exclusions;
  std::vector<ClothRange> cloths;
  std::optional<Dressed> dressed;  ///< if cloth asks to be led out

  // Bodies of triangles, which the scene moves. Where a list holds vertices of both, those of bodies come
  // after those of cloths, as body_triangles counts them.
  std::vector<dvec3> body_position;                          ///< [body_vertex_count] at time 0 [m]
  std::vector<std::array<std::uint32_t, 3>> body_triangles;  ///< vertices count from vertex_count() on
  std::vector<std::uint32_t> vertex_body;                    ///< [body_vertex_count] index into `bodies`
  std::vector<BodyRange> bodies;

  const Batch<elements::Spring>& springs() const { return elements.of<elements::Spring>(); }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(rest_position.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size()); }
  std::uint32_t body_vertex_count() const { return static_cast<std::uint32_t>(body_position.size()); }
};

/// Builds the arrays. An error names the JSON Pointer of a mass that leaves a vertex too light, of a pin or
/// weight that selects no vertex, of a kind of self-collision that the start's crossings rule out, or of a
/// body that cloth starts through or in.
Result<Model> build(const scene::Scene& scene);

/// Gives the elements of a model that is in the scene's order the numbers of the scene's materials. The scene
/// may differ from the one that the model was built of in these, and in what elements have nothing of. Error:
/// the scene has other elements.
Status take_materials(Model& model, const scene::Scene& scene);

/// For each vertex the two other corners of each of its triangles, counter-clockwise, in the order of
/// `vertex_triangles`. shaders/stream/normal.glsl reads this list.
std::vector<std::uint32_t> vertex_fans(const Model& model);

}  // namespace clothlab::model
