// The cloths of a simulation as the renderer draws them: buffers of their topology, and the normals pass.
#pragma once

#include <glad/gl.h>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/sim/simulation.h"

namespace clothlab::render {

class ClothMesh {
 public:
  /// Takes the simulation's present positions, where they lie, and computes their normals with
  /// `normals_program`. Good until the simulation's next step.
  ClothMesh(const sim::Simulation& simulation, const gl::Program& normals_program);
  ~ClothMesh();
  ClothMesh(const ClothMesh&) = delete;
  ClothMesh& operator=(const ClothMesh&) = delete;

  /// Draws every cloth with cloth.vert's attributes; sets cloth.frag's colour and pattern.
  void draw(const sim::Simulation& simulation) const;
  /// Draws all triangles at once with the program in use.
  void draw_plain() const;

 private:
  void compute_normals(const sim::Simulation& simulation, const gl::Program& program) const;

  gl::Buffer triangles_, texture_coordinates_, normals_;
  GLuint vertex_array_ = 0;
  GLuint vertex_count_;
  GLsizei triangle_count_;
};

}  // namespace clothlab::render
