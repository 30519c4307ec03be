#include "server/mesh/mesh.h"

#include <algorithm>
#include <cctype>

#include "server/mesh/open_places.h"
#include "server/mesh/raw.h"
#include "server/mesh/text.h"

namespace clothlab::mesh {

namespace {

bool ends_in(const std::string& name, std::string_view ending) {
  return name.size() >= ending.size() &&
         std::equal(ending.begin(), ending.end(), name.end() - static_cast<std::ptrdiff_t>(ending.size()),
                    [](char wanted, unsigned char c) { return wanted == std::tolower(c); });
}

bool is_ply(std::string_view bytes, const std::string& name) {
  return ends_in(name, ".ply") || bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

bool is_gltf(std::string_view bytes, const std::string& name) {
  if (ends_in(name, ".glb") || ends_in(name, ".gltf") || bytes.starts_with("glTF")) return true;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first < bytes.size() && bytes[first] == '{';
}

}  // namespace

std::string Mesh::place_of(std::size_t triangle) const {
  return line_word + (" " + std::to_string(face_line[triangle]));
}

std::string Raw::place(std::size_t line) const {
  std::string text = line_word;
  text += ' ';
  return text += std::to_string(line);
}

Error Raw::error(std::size_t line, std::string what, std::string remedy) const {
  const std::string in = name.empty() ? "" : name + ", ";
  return Error{in + place(line), std::move(what), std::move(remedy)};
}

Error no_part(const std::string& file, const std::string& node, const std::vector<std::string>& parts) {
  std::string remedy;
  for (const std::string& part : parts) remedy += (remedy.empty() ? "one of " : ", ") + quoted(part);
  if (parts.size() == most_parts_named) remedy += ", ...";
  return Error{file, "no object, group or node " + quoted(node),
               remedy.empty() ? "no \"node\": this file names no parts" : remedy};
}

Status Raw::leave_out(Fault fault, std::size_t line, const Error& wrong) {
  if (!mend) return wrong;
  mended.add(fault, place(line));
  if (!no_cloth) no_cloth = wrong;
  return ok();
}

void Raw::name_part(const std::string& part) {
  if (parts.size() < most_parts_named && std::find(parts.begin(), parts.end(), part) == parts.end())
    parts.push_back(part);
}

Status Raw::add_vertex(const glm::dvec3& place, std::size_t line, const Limits& limits) {
  if (vertices.size() >= limits.vertices)
    return error(line, "more than " + std::to_string(limits.vertices) + " vertices", "at most so many");
  vertices.push_back(place);
  return ok();
}

Status Raw::add_placeless(const Error& wrong, std::size_t line, const Limits& limits) {
  if (const Status left = leave_out(Fault::vertex, line, wrong); !left) return left.error();
  placeless.push_back(static_cast<std::uint32_t>(vertices.size()));
  return add_vertex(glm::dvec3(0.0), line, limits);
}

Status Raw::add_face(const std::vector<Corner>& of, std::size_t line, const Limits& limits) {
  if (mend && of.size() < 3) {
    mended.add(Fault::no_area, place(line));
    return ok();
  }
  if (of.size() < 3 || of.size() > max_corners)
    return leave_out(Fault::face, line,
                     error(line,
                           "a face of " +
                               (of.size() > max_corners ? "more than " + std::to_string(max_corners)
                                                        : std::to_string(of.size())) +
                               " corners",
                           "3 to " + std::to_string(max_corners)));
  if (std::any_of(of.begin(), of.end(), [&](const Corner& corner) {
        return std::binary_search(placeless.begin(), placeless.end(), corner.vertex);
      }))
    return ok();  // told with the vertex
  triangles += of.size() - 2;
  if (triangles > limits.triangles)
    return error(line, "more than " + std::to_string(limits.triangles) + " triangles", "at most so many");
  faces.push_back({static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(of.size()),
                   static_cast<std::uint32_t>(line)});
  corners.insert(corners.end(), of.begin(), of.end());
  return ok();
}

Result<Mesh> assemble_triangles(const std::vector<glm::dvec3>& vertices,
                                const std::vector<std::array<std::uint32_t, 3>>& triangles, bool mend) {
  Raw raw;
  raw.mend = mend;
  raw.most_triangles = triangles.size() + (1u << 18);
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

Result<Mesh> read(std::string_view bytes, const std::string& name, const Limits& limits,
                  const Reading& reading, const Beside& beside) {
  if (bytes.size() > limits.bytes)
    return Error{name, std::to_string(bytes.size()) + " bytes", "at most " + std::to_string(limits.bytes)};
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // which some programs put before UTF-8
  if (bytes.starts_with(byte_order_mark)) bytes.remove_prefix(byte_order_mark.size());
  Result<Raw> raw = is_ply(bytes, name)    ? read_ply(bytes, name, limits, reading)
                    : is_gltf(bytes, name) ? read_gltf(bytes, name, limits, reading, beside)
                                           : read_obj(bytes, name, limits, reading);
  if (!raw) return raw.error();
  raw->mend = reading.mend;
  raw->part = !reading.node.empty();
  raw->most_triangles = limits.triangles;
  return assemble(*raw);
}

}  // namespace clothlab::mesh
