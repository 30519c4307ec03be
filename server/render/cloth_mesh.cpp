#include "server/render/cloth_mesh.h"

#include <cmath>
#include <cstdint>
#include <glm/vec4.hpp>
#include <string>

#include "shaders/slots.h"

namespace clothlab::render {

namespace {

/// The channel at character `at` of "#rrggbb" as linear light in [0, 1].
float linear_channel(const std::string& color, std::size_t at) {
  const double encoded = std::stoi(color.substr(at, 2), nullptr, 16) / 255.0;
  return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

/// The number that cloth.frag has for a texture.
GLint pattern_number(const std::string& texture) {
  if (texture == "weave") return 1;
  if (texture == "checker") return 2;
  if (texture == "stripes") return 3;
  return 0;
}

void attribute(GLuint vertex_array, GLuint index, GLint components) {
  glEnableVertexArrayAttrib(vertex_array, index);
  glVertexArrayAttribFormat(vertex_array, index, components, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vertex_array, index, index);
}

/// The positions [m] as the kernels read them: with a fourth component, 1.
std::vector<glm::vec4> padded(const std::vector<glm::vec3>& positions) {
  std::vector<glm::vec4> all;
  all.reserve(positions.size());
  for (const glm::vec3& position : positions) all.emplace_back(position, 1.0f);
  return all;
}

}  // namespace

ClothMesh::ClothMesh(const model::Model& model, const std::vector<glm::vec3>& positions,
                     const gl::Program& normals_program)
    : positions_(gl::Buffer(padded(positions)), GL_RGBA32F),
      triangles_(model.triangles),
      texture_coordinates_(model.texture_coordinates),
      normals_(model.vertex_count() * 4 * sizeof(float)),
      ranges_(model.cloths),
      vertex_count_(model.vertex_count()),
      triangle_count_(static_cast<GLsizei>(model.triangle_count())) {
  glCreateVertexArrays(1, &vertex_array_);
  attribute(vertex_array_, attribute_position, 3);
  attribute(vertex_array_, attribute_normal, 3);
  attribute(vertex_array_, attribute_texture_coordinate, 2);
  glVertexArrayVertexBuffer(vertex_array_, attribute_normal, normals_.id(), 0, 4 * sizeof(float));
  glVertexArrayVertexBuffer(vertex_array_, attribute_texture_coordinate, texture_coordinates_.id(), 0,
                            2 * sizeof(float));
  glVertexArrayElementBuffer(vertex_array_, triangles_.id());
  glVertexArrayVertexBuffer(vertex_array_, attribute_position, positions_.buffer.id(), 0, 4 * sizeof(float));
  compute_normals(model, normals_program);
}

ClothMesh::~ClothMesh() {
  glDeleteVertexArrays(1, &vertex_array_);
}

void ClothMesh::compute_normals(const model::Model& model, const gl::Program& program) const {
  const gl::TextureBuffer fan_offsets(gl::Buffer(model.vertex_triangles.offsets), GL_R32UI);
  const gl::TextureBuffer fans(gl::Buffer(model::vertex_fans(model)), GL_RG32UI);
  program.use();
  program.set("vertex_count", static_cast<GLint>(vertex_count_));
  positions_.bind(unit_position);
  fan_offsets.bind(unit_fan_offsets);
  fans.bind(unit_fans);
  normals_.bind_storage(slot_normals);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  glDispatchCompute((vertex_count_ + 63) / 64, 1, 1);
  glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
}

void ClothMesh::draw(const scene::Scene& scene) const {
  glBindVertexArray(vertex_array_);
  for (std::size_t index = 0; index < ranges_.size(); ++index) {
    const scene::Cloth& cloth = scene.cloths[index];
    glUniform3f(uniform_color, linear_channel(cloth.color, 1), linear_channel(cloth.color, 3),
                linear_channel(cloth.color, 5));
    glUniform1i(uniform_pattern, pattern_number(cloth.texture));
    const std::uintptr_t first_byte = ranges_[index].first_triangle * 3 * sizeof(std::uint32_t);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * ranges_[index].triangle_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(first_byte));
  }
}

void ClothMesh::draw_plain() const {
  glBindVertexArray(vertex_array_);
  glDrawElements(GL_TRIANGLES, 3 * triangle_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace clothlab::render
