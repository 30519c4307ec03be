// Draws the colliders. Only solids.cpp defines how each kind of shape looks; a kind that is missing there
// does not compile.
#pragma once

#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"

namespace clothlab::render {

class Solids {
 public:
  /// The parts of a picture, in drawing order: shadows into the shadow map, planes, then all other shapes.
  enum class Layer { shadow, ground, body };

  Solids();
  ~Solids();
  Solids(const Solids&) = delete;
  Solids& operator=(const Solids&) = delete;

  Status load();
  /// Draws one layer of the colliders. `shadow` is drawn with the program in use, whose vertex shader
  /// includes shaders/render/placed.glsl.
  void draw(Layer layer, const std::vector<scene::Collider>& colliders) const;

  /// Where the program in use, whose vertex shader includes shaders/render/placed.glsl, places a mesh. By
  /// default a vertex stays where it is.
  struct Place {
    glm::vec3 middle{0.0f};  ///< [m]
    float radius = 0;        ///< [m]
    glm::mat3 axes{1.0f};    ///< columns of unit length
    glm::vec3 extent{1.0f};  ///< [m]
  };
  static void place(const Place& place);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::render
