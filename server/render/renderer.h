// Draws a simulation's present state to a picture without a window: normals by a compute pass, then the cloth
// by vertex, geometry and fragment shader, the colliders, a shadow. Uses the GL context that is current on
// the calling thread.
#pragma once

#include <memory>

#include "server/base/result.h"
#include "server/render/image.h"
#include "server/sim/simulation.h"

namespace clothlab::render {

class Renderer {
 public:
  /// Compiles the shaders. Errors name the shader's file and line.
  static Result<std::unique_ptr<Renderer>> create();
  ~Renderer();

  /// The present state, `width` x `height` pixels, each in [1, max_image_side], framed so that all of it is
  /// seen. Waits for the GPU. A vertex that is not finite is left out of the framing.
  Result<Image> render(const sim::Simulation& simulation, int width, int height);

 private:
  Renderer();
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::render
