// Draws a moment of a scene to a picture without a window: normals by a compute pass, then the cloth by
// vertex, geometry and fragment shader, the colliders, a shadow. Uses the GL context that is current on the
// calling thread, which need not be the one that simulated the moment.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/render/camera.h"
#include "server/render/image.h"
#include "server/scene/scene.h"

namespace clothlab::render {

/// What is drawn: references, all valid until the drawing is done.
struct DrawnMoment {
  const scene::Scene& scene;                      ///< for the cloths' colours and textures
  const model::Model& model;                      ///< of that scene
  const std::vector<glm::vec3>& positions;        ///< [vertex_count] [m]
  const std::vector<scene::Collider>& colliders;  ///< placed as at that moment
  /// The name of the cloths and finite colliders that the picture is of; none, or of nothing: all of them.
  std::optional<std::string> subject{};
  View view{};
  bool clear = false;  ///< without background: planes are only the shadows on them
};

class Renderer {
 public:
  /// Compiles the shaders. Errors name the shader's file and line.
  static Result<std::unique_ptr<Renderer>> create();
  ~Renderer();

  /// `width` x `height` pixels, each in [1, max_image_side], which the moment's subject fills unless its view
  /// says otherwise. Waits for the GPU. A vertex that is not finite is left out of the framing.
  Result<Image> render(const DrawnMoment& moment, int width, int height);

 private:
  Renderer();
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::render
