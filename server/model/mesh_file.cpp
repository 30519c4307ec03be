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
  std::string out = "# " + comment + "\n";
  out.reserve(out.size() + positions.size() * 56 + model.triangles.size() * 40);
  const auto numbers = [&out](const char* what, std::initializer_list<float> values) {
    out += what;
    for (const float value : values) {
      out += ' ';
      append_text(out, value);
    }
    out += '\n';
  };
  for (const glm::vec3& p : positions) numbers("v", {p.x, p.y, p.z});
  for (const glm::vec2& t : model.texture_coordinates) numbers("vt", {t.x, t.y});
  for (const auto& triangle : model.triangles) {
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

std::string ply_bytes(const Model& model, const std::vector<glm::vec3>& positions,
                      const std::string& comment) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\n";
  out += "element vertex " + std::to_string(positions.size()) + "\n";
  out += "property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n";
  out += "element face " + std::to_string(model.triangles.size()) + "\n";
  out += "property list uchar uint vertex_indices\nend_header\n";
  for (std::size_t vertex = 0; vertex < positions.size(); ++vertex) {
    append_bytes(out, positions[vertex]);
    append_bytes(out, model.texture_coordinates[vertex]);
  }
  for (const auto& triangle : model.triangles) {
    out += '\3';
    append_bytes(out, triangle);
  }
  return out;
}

}  // namespace clothlab::model
