// Draws the colliders. Only solids.cpp defines how each kind of shape looks; a kind that is missing there
// does not compile.
#pragma once

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
  /// Draws one layer of the colliders. `shadow` is drawn with the program in use, whose uniform_placed places
  /// a unit shape (shaders/render/depth.vert).
  void draw(Layer layer, const std::vector<scene::Collider>& colliders) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::render
