// A mesh as its file has it: polygons, and corners as numbers of places and texture coordinates. Internal to
// server/mesh.
#pragma once

#include <limits>

#include "server/mesh/mending.h"
#include "server/mesh/mesh.h"

namespace clothlab::mesh {

inline constexpr std::uint32_t no_texture = 0xffffffffu;

struct Corner {
  std::uint32_t vertex = 0;
  std::uint32_t texture = no_texture;
};

struct Face {
  std::uint32_t first = 0, count = 0;  ///< its part of Raw::corners
  std::uint32_t line = 0;
};

struct Raw {
  std::string name;   ///< of the file; empty: of none
  bool mend = true;   ///< Reading::mend
  bool part = false;  ///< of the file: Reading::node names it
  std::vector<glm::dvec3> vertices;
  std::vector<glm::dvec2> texture;
  std::vector<Corner> corners;
  std::vector<Face> faces;
  std::size_t triangles = 0;  ///< into which the faces will be cut
  /// Of the last digit of the coordinate that is written with the most digits [m]; infinite if none is
  /// written.
  double unit = std::numeric_limits<double>::infinity();
  const char* line_word = "line";
  std::size_t most_triangles = std::numeric_limits<std::size_t>::max();
  Mending mended;
  std::vector<std::string> parts;        ///< Mesh::part_names
  std::vector<std::uint32_t> placeless;  ///< vertices without a place, rising: their faces are left out
  std::optional<Error> no_cloth;         ///< Mesh::no_cloth

  /// "line 12".
  std::string place(std::size_t line) const;
  Error error(std::size_t line, std::string what, std::string remedy) const;
  /// The error `wrong` if nothing is mended. Else what it tells is left out, and no cloth can be made of the
  /// file.
  Status leave_out(Fault fault, std::size_t line, const Error& wrong);
  /// The file has an object, group or node of this name.
  void name_part(const std::string& part);
  /// An error if there would be more vertices than allowed.
  Status add_vertex(const glm::dvec3& place, std::size_t line, const Limits& limits);
  /// The same of one whose place is `wrong`.
  Status add_placeless(const Error& wrong, std::size_t line, const Limits& limits);
  /// An error if the face has too few or too many corners and that is not mended, or there would be too many
  /// triangles.
  Status add_face(const std::vector<Corner>& of, std::size_t line, const Limits& limits);
};

Result<Raw> read_obj(std::string_view text, const std::string& name, const Limits& limits,
                     const Reading& reading);
Result<Raw> read_ply(std::string_view bytes, const std::string& name, const Limits& limits,
                     const Reading& reading);
Result<Raw> read_gltf(std::string_view bytes, const std::string& name, const Limits& limits,
                      const Reading& reading, const Beside& beside);

/// So many names of a file's parts are kept, for errors.
inline constexpr std::size_t most_parts_named = 12;
/// The error that a file has no part of this name, but those of `parts`.
Error no_part(const std::string& file, const std::string& node, const std::vector<std::string>& parts);

/// Which vertices are one (join.cpp).
struct Joined {
  /// For each vertex the first of those that are one with it, which is itself if no earlier one is.
  std::vector<std::uint32_t> first;
  double reach = 0.0;  ///< what is no farther apart is at the same place [m]
  /// Vertices that are one with another only as they are within a micrometre of it.
  std::vector<std::uint32_t> welded;
};
/// If not `rounded`, only those at exactly the same place are one.
Joined joined(const Raw& raw, bool rounded);

/// Makes triangles of the polygons, merges vertices at the same place, leaves out unused ones, turns
/// triangles so that neighbours have the same side outside, and mends or refuses what cannot be simulated.
Result<Mesh> assemble(const Raw& raw);

/// Divides the edges on which corners of others lie, no farther off than `reach` [m], at these corners.
/// Triangles that would be too many, or without area, stay as they are. True: some were divided.
bool divide_edges(Mesh& mesh, double reach, const Raw& raw, Mending& mended);

/// Cuts a polygon into triangles that do not overlap, even if it is not convex: `triangles` gets triples of
/// indices into `corners`. `budget` bounds the work over all polygons of a file. Returns an empty text, or
/// what is wrong with the polygon.
std::string triangulate(const std::vector<glm::dvec3>& corners,
                        std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& budget);

/// The same of a polygon that crosses itself or is folded: its triangles lie on each other, and may have no
/// area.
void triangulate_folded(const std::vector<glm::dvec3>& corners,
                        std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& budget);

}  // namespace clothlab::mesh
