// A mesh as its file has it: polygons, and corners as numbers of places and texture coordinates. Internal to
// server/mesh.
#pragma once

#include <limits>

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
  std::string name;  ///< of the file; empty: of none
  std::vector<glm::dvec3> vertices;
  std::vector<glm::dvec2> texture;
  std::vector<Corner> corners;
  std::vector<Face> faces;
  std::size_t triangles = 0;  ///< into which the faces will be cut
  /// Of the last digit of the coordinate that is written with the most digits [m]; infinite if none is
  /// written.
  double unit = std::numeric_limits<double>::infinity();
  const char* line_word = "line";

  Error error(std::size_t line, std::string what, std::string remedy) const;
  /// An error if there would be more vertices than allowed.
  Status add_vertex(const glm::dvec3& place, std::size_t line, const Limits& limits);
  /// An error if the face has too few or too many corners, or there would be too many triangles.
  Status add_face(const std::vector<Corner>& of, std::size_t line, const Limits& limits);
};

Result<Raw> read_obj(std::string_view text, const std::string& name, const Limits& limits);
Result<Raw> read_ply(std::string_view bytes, const std::string& name, const Limits& limits);

/// For each vertex the first of those that are one with it, which is itself if no earlier one is (join.cpp).
/// If not `rounded`, only those at exactly the same place are.
std::vector<std::uint32_t> joined(const Raw& raw, bool rounded);

/// Makes triangles of the polygons, merges vertices at the same place, leaves out unused ones, turns
/// triangles so that neighbours have the same side outside, and refuses what cannot be simulated.
Result<Mesh> assemble(const Raw& raw);

/// Cuts a polygon into triangles that do not overlap, even if it is not convex: `triangles` gets triples of
/// indices into `corners`. `budget` bounds the work over all polygons of a file. Returns an empty text, or
/// what is wrong with the polygon.
std::string triangulate(const std::vector<glm::dvec3>& corners,
                        std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& budget);

}  // namespace clothlab::mesh
