#include "server/render/body_surface.h"

#include <cstddef>
#include <glm/geometric.hpp>

#include "shaders/slots.h"

namespace clothlab::render {

namespace {

/// A vertex as shaders/render/placed.glsl has it.
struct BodyVertex {
  glm::vec3 corner, direction;
};

std::vector<BodyVertex> vertices_of(const scene::TriangleMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.vertices.size(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : mesh.triangles) {
    const glm::dvec3 twice_area =
        glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
    for (const std::uint32_t corner : {a, b, c}) normals[corner] += twice_area;
  }
  std::vector<BodyVertex> vertices;
  vertices.reserve(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double length = glm::length(normals[i]);
    vertices.push_back(
        {glm::vec3(mesh.vertices[i]), length > 0.0 ? glm::vec3(normals[i] / length) : glm::vec3(0, 1, 0)});
  }
  return vertices;
}

}  // namespace

BodySurface::BodySurface(const scene::TriangleMesh& mesh)
    : vertices_(vertices_of(mesh)),
      triangles_(mesh.triangles),
      corners_(static_cast<GLsizei>(3 * mesh.triangles.size())) {
  glCreateVertexArrays(1, &array_);
  glVertexArrayElementBuffer(array_, triangles_.id());
  attribute(attribute_position, offsetof(BodyVertex, corner));
  attribute(attribute_normal, offsetof(BodyVertex, direction));
}

void BodySurface::attribute(GLuint index, std::size_t offset) const {
  glEnableVertexArrayAttrib(array_, index);
  glVertexArrayAttribFormat(array_, index, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayVertexBuffer(array_, index, vertices_.id(), static_cast<GLintptr>(offset), sizeof(BodyVertex));
  glVertexArrayAttribBinding(array_, index, index);
}

BodySurface::~BodySurface() {
  glDeleteVertexArrays(1, &array_);
}

void BodySurface::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace clothlab::render
