#include "server/model/mesh_file.h"

#include <bit>
#include <charconv>
#include <initializer_list>

namespace clothlab::model {

namespace {

static_assert(std::endian::native == std::endian::little, "ply_bytes copies numbers as they lie in memory");

/// The shortest text that reads back as the same number.
template <class Number>
void append_text(std::string& out, Number value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, end.ptr);
}

template <class Value>
void append_bytes(std::string& out, const Value& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string obj_text(const Model& model, const std::vector<glm::vec3>& positions,
                     const std::string& comment) {
  return obj_text(model.triangles, model.texture_coordinates, positions, comment);
}

std::string obj_text(std::span<const std::array<std::uint32_t, 3>> triangles,
                     std::span<const glm::vec2> texture_coordinates, std::span<const glm::vec3> positions,
                     const std::string& comment) {
  std::string out = "# " + comment + "\n";
  out.reserve(out.size() + positions.size() * 56 + triangles.size() * 40);
  const auto numbers = [&out](const char* what, std::initializer_list<float> values) {
    out += what;
    for (const float value : values) {
      out += ' ';
      append_text(out, value);
    }
    out += '\n';
  };
  for (const glm::vec3& p : positions) numbers("v", {p.x, p.y, p.z});
  for (const glm::vec2& t : texture_coordinates) numbers("vt", {t.x, t.y});
  for (const auto& triangle : triangles) {
    out += 'f';
    for (const std::uint32_t corner : triangle) {
      out += ' ';
      append_text(out, corner + 1);
      out += '/';
      append_text(out, corner + 1);
    }
    out += '\n';
  }
  return out;
}

namespace {

/// The header of a PLY file whose vertices have these `properties` after their three coordinates.
std::string ply_header(std::size_t vertices, std::size_t triangles, const std::string& properties,
                       const std::string& comment) {
  return "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\nelement vertex " +
         std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\n" + properties +
         "element face " + std::to_string(triangles) +
         "\nproperty list uchar uint vertex_indices\nend_header\n";
}

void append_triangles(std::string& out, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (const auto& triangle : triangles) {
    out += '\3';
    append_bytes(out, triangle);
  }
}

}  // namespace

std::string ply_bytes(const Model& model, const std::vector<glm::vec3>& positions,
                      const std::string& comment) {
  std::string out =
      ply_header(positions.size(), model.triangles.size(), "property float s\nproperty float t\n", comment);
  for (std::size_t vertex = 0; vertex < positions.size(); ++vertex) {
    append_bytes(out, positions[vertex]);
    append_bytes(out, model.texture_coordinates[vertex]);
  }
  append_triangles(out, model.triangles);
  return out;
}

std::string ply_bytes(const scene::TriangleMesh& mesh, const std::string& comment) {
  std::string out = ply_header(mesh.vertices.size(), mesh.triangles.size(), "", comment);
  out.reserve(out.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const dvec3& vertex : mesh.vertices) append_bytes(out, glm::vec3(vertex));
  append_triangles(out, mesh.triangles);
  return out;
}

std::optional<std::string> collider_ply(const scene::Scene& scene, const std::string& name) {
  for (const scene::Collider& collider : scene.colliders)
    if (const auto* body = std::get_if<scene::Body>(&collider.shape); body && collider.name == name)
      return ply_bytes(*body->mesh, "a collider of Clothlab");
  return std::nullopt;
}

}  // namespace clothlab::model
