// Draws the colliders. How a kind of shape looks is said in solids.cpp alone, and a kind that is not does not
// compile.
#pragma once

#include <memory>
#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"

namespace clothlab::render {

class Solids {
 public:
  /// What is drawn at a time: shadows into their map, the grounds that the rest stands on, then the bodies.
  enum class Layer { shadow, ground, body };

  Solids();
  ~Solids();
  Solids(const Solids&) = delete;
  Solids& operator=(const Solids&) = delete;

  Status load();
  /// `shadow` is drawn with the program in use, whose uniform_placed places a unit shape
  /// (shaders/render/depth.vert).
  void draw(Layer layer, const std::vector<scene::Collider>& colliders) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::render
