// The surface of a body of triangles, shaded smoothly, as shaders/render/placed.glsl takes it.
#pragma once

#include "server/gl/buffer.h"
#include "server/scene/scene.h"

namespace clothlab::render {

class BodySurface {
 public:
  explicit BodySurface(const scene::TriangleMesh& mesh);
  ~BodySurface();
  BodySurface(const BodySurface&) = delete;
  BodySurface& operator=(const BodySurface&) = delete;

  void draw() const;

 private:
  void attribute(GLuint index, std::size_t offset) const;

  gl::Buffer vertices_, triangles_;
  GLuint array_ = 0;
  GLsizei corners_ = 0;
};

}  // namespace clothlab::render
