// Bodies of triangles: their part of the model, where they are at a time, and what is inside them.
#pragma once

#include <vector>

#include "server/model/box_tree.h"
#include "server/model/model.h"

namespace clothlab::model {

/// True for a box at rest among surfaces: beside the solid that keeps vertices out, its corners and edges
/// keep apart from triangles and edges of cloth, which would else cut its corners and catch there. (Those of
/// a box that moves would be driven through the cloth: it keeps vertices farther away instead,
/// `contact_margin`.)
bool has_edges(const scene::Scene& scene, const scene::Collider& collider);

/// Adds the scene's bodies to a model that has all its cloths.
void add_bodies(Model& model, const scene::Scene& scene);

/// Where the vertices of all bodies are at `time` [s] [body_vertex_count] [m].
std::vector<dvec3> body_positions(const Model& model, double time);

/// What hangs together in a body: parts share no vertex.
struct BodyPart {
  std::uint32_t number;  ///< the same for all triangles of the part
  bool open;             ///< it has no inside (BodyInside)
};
/// The part of each of the body's triangles, in their order. `body` is an index into Model::bodies.
std::vector<BodyPart> parts_of(const Model& model, std::uint32_t body);

/// Tells whether points are inside a body. Only a closed part has an inside: one whose edges each have as
/// many triangles that go along them in one direction as in the other. An open part is a sheet, and cloth may
/// be on either side of it.
class BodyInside {
 public:
  /// `position`: of all bodies' vertices [body_vertex_count] [m], finite. `body` is an index into
  /// Model::bodies.
  BodyInside(const Model& model, std::uint32_t body, const std::vector<dvec3>& position);
  BodyInside(const BodyInside&) = delete;
  BodyInside& operator=(const BodyInside&) = delete;

  /// True if closed parts wind around the point, which is on none of their triangles: parts that overlap are
  /// one body, and a part that is turned inside out within another one is a hollow. Exact.
  bool contains(const dvec3& point) const;

 private:
  std::vector<std::array<dvec3, 3>> triangles_;  ///< of the closed parts
  std::vector<Bounds> boxes_;
  BoxTree tree_;
  double farthest_;  ///< the largest x of any corner [m]
};

}  // namespace clothlab::model
