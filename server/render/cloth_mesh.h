// The cloths as the renderer draws them: buffers of their topology and positions, and the normals pass.
#pragma once

#include <glad/gl.h>

#include <glm/vec3.hpp>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::render {

class ClothMesh {
 public:
  /// Uploads `positions` [m] of the model's vertices and computes their normals with `normals_program`.
  ClothMesh(const model::Model& model, const std::vector<glm::vec3>& positions,
            const gl::Program& normals_program);
  ~ClothMesh();
  ClothMesh(const ClothMesh&) = delete;
  ClothMesh& operator=(const ClothMesh&) = delete;

  /// Draws every cloth with cloth.vert's attributes; sets cloth.frag's colour and pattern to the scene's.
  void draw(const scene::Scene& scene) const;
  /// Draws all triangles at once with the program in use.
  void draw_plain() const;

 private:
  void compute_normals(const model::Model& model, const gl::Program& program) const;

  gl::TextureBuffer positions_;
  gl::Buffer triangles_, texture_coordinates_, normals_;
  std::vector<model::ClothRange> ranges_;
  GLuint vertex_array_ = 0;
  GLuint vertex_count_;
  GLsizei triangle_count_;
};

}  // namespace clothlab::render
