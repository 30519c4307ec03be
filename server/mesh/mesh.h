// Reads a triangle mesh from the bytes of an .obj, .ply, .glb or .gltf file: checked, mended where it can be,
// and with an error that names the file's line for all else. See README.md here.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace clothlab::mesh {

/// In Mesh::vertex_of: the vertex of the file is part of no face.
inline constexpr std::uint32_t no_vertex = 0xffffffffu;

struct Mesh {
  std::vector<glm::dvec3> vertices;                     ///< [vertex_count] [m], in the file's order
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [triangle_count], counter-clockwise
  /// [triangle_count] texture coordinates of each triangle's corners; empty unless every face has them. A
  /// vertex on a seam has one place, and in each triangle its own texture coordinates.
  std::vector<std::array<glm::dvec2, 3>> texture;
  /// [vertices of the file] the vertex that became of each, or no_vertex.
  std::vector<std::uint32_t> vertex_of;
  std::size_t merged = 0;   ///< vertices of the file that are one with an earlier one, at its place
  std::size_t unused = 0;   ///< vertices of the file that are part of no face
  std::size_t flipped = 0;  ///< triangles turned over, so that each part has one outside
  std::size_t parts = 0;    ///< pieces that share no vertex
  /// Names of the file's objects, groups and nodes, each once, in its order: the first twelve.
  std::vector<std::string> part_names;
  /// Where to find the triangle's face in the file, e.g. "line 12", for errors.
  std::string place_of(std::size_t triangle) const;

  std::vector<std::string>
      notes;  ///< what a person should know of it, by line: what was mended, where it is open, in sentences
  /// Why it can be a body and no cloth: what is wrong with the file and cannot be mended, but does no harm to
  /// a body.
  std::optional<Error> no_cloth;

  std::vector<std::uint32_t> face_line;  ///< [triangle_count]
  const char* line_word = "line";        ///< of a binary file, which has no lines: "face"
};

/// True if the three points are in line or coincide, as far as 32-bit floats can tell.
bool has_no_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// What a file may hold at most, checked before anything of that size is allocated.
struct Limits {
  std::size_t bytes = 0, vertices = 0, triangles = 0;
};

/// The largest coordinate [m], of either sign.
inline constexpr double largest_coordinate = 1e6;
/// The most corners of a polygon.
inline constexpr std::size_t max_corners = 1024;

/// What of a file is read, and how.
struct Reading {
  bool mend = true;    ///< what can be mended is, with a note; false: it is refused
  std::string node{};  ///< the name of one object, group or node of the file; empty: all of it
  auto operator<=>(const Reading&) const = default;
};
/// The bytes of a file beside the one that is read, by the name that it has there: a buffer of a .gltf file.
using Beside = std::function<Result<std::string>(const std::string& name)>;

/// Reads the bytes of a file. It is a PLY or glTF file if it starts as one or `name` ends in ".ply", ".glb"
/// or
/// ".gltf", else an OBJ file. Error: `where` is `name` and the line, `what` was found there and `remedy` is
/// allowed. `beside` (may be empty): what a .gltf file names.
Result<Mesh> read(std::string_view bytes, const std::string& name, const Limits& limits,
                  const Reading& reading = {}, const Beside& beside = {});

/// The same of triangles that are given as such, each of three different vertices that exist. Errors count
/// them from 0: "triangle 3".
Result<Mesh> assemble_triangles(const std::vector<glm::dvec3>& vertices,
                                const std::vector<std::array<std::uint32_t, 3>>& triangles, bool mend = true);

/// Mesh::notes of triangles that stay as they are given, counted from 0.
std::vector<std::string> notes_of_triangles(const std::vector<glm::dvec3>& vertices,
                                            const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace clothlab::mesh
