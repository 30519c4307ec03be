#include "server/mesh/mesh.h"

#include <algorithm>
#include <cctype>

#include "server/mesh/open_places.h"
#include "server/mesh/raw.h"

namespace clothlab::mesh {

namespace {

bool ends_in_ply(const std::string& name) {
  if (name.size() < 4) return false;
  std::string end = name.substr(name.size() - 4);
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end == ".ply";
}

}  // namespace

std::string Mesh::place_of(std::size_t triangle) const {
  return line_word + (" " + std::to_string(face_line[triangle]));
}

Error Raw::error(std::size_t line, std::string what, std::string remedy) const {
  const std::string in = name.empty() ? "" : name + ", ";
  return Error{in + line_word + " " + std::to_string(line), std::move(what), std::move(remedy)};
}

Status Raw::add_vertex(const glm::dvec3& place, std::size_t line, const Limits& limits) {
  if (vertices.size() >= limits.vertices)
    return error(line, "more than " + std::to_string(limits.vertices) + " vertices", "at most so many");
  vertices.push_back(place);
  return ok();
}

Status Raw::add_face(const std::vector<Corner>& of, std::size_t line, const Limits& limits) {
  if (of.size() < 3 || of.size() > max_corners)
    return error(line,
                 "a face of " +
                     (of.size() > max_corners ? "more than " + std::to_string(max_corners)
                                              : std::to_string(of.size())) +
                     " corners",
                 "3 to " + std::to_string(max_corners));
  triangles += of.size() - 2;
  if (triangles > limits.triangles)
    return error(line, "more than " + std::to_string(limits.triangles) + " triangles", "at most so many");
  faces.push_back({static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(of.size()),
                   static_cast<std::uint32_t>(line)});
  corners.insert(corners.end(), of.begin(), of.end());
  return ok();
}

Result<Mesh> assemble_triangles(const std::vector<glm::dvec3>& vertices,
                                const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Raw raw;
  raw.line_word = "triangle";
  raw.vertices = vertices;
  raw.triangles = triangles.size();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    raw.faces.push_back({3 * i, 3, i});
    for (const std::uint32_t corner : triangles[i]) raw.corners.push_back({corner, no_texture});
  }
  return assemble(raw);
}

std::vector<std::string> notes_of_triangles(const std::vector<glm::dvec3>& vertices,
                                            const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return notes_of(open_places(vertices, triangles, sides_of(triangles)),
                  [](std::size_t triangle) { return "triangle " + std::to_string(triangle); });
}

Result<Mesh> read(std::string_view bytes, const std::string& name, const Limits& limits) {
  if (bytes.size() > limits.bytes)
    return Error{name, std::to_string(bytes.size()) + " bytes", "at most " + std::to_string(limits.bytes)};
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // which some programs put before UTF-8
  if (bytes.starts_with(byte_order_mark)) bytes.remove_prefix(byte_order_mark.size());
  const bool ply = ends_in_ply(name) || bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
  Result<Raw> raw = ply ? read_ply(bytes, name, limits) : read_obj(bytes, name, limits);
  if (!raw) return raw.error();
  return assemble(*raw);
}

}  // namespace clothlab::mesh
