// What was mended in a file, by kind: how often, and where first. Internal to server/mesh.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clothlab::mesh {

/// What may be wrong with a file that can be a mesh all the same.
enum class Fault {
  word,          ///< a line that begins with no word of the format
  vertex,        ///< a vertex without a place; its faces are left out
  texture,       ///< texture coordinates that are no numbers
  face,          ///< a face that cannot be read
  curve,         ///< part of a curved surface
  no_area,       ///< a face or a triangle of one, without area
  corner_twice,  ///< a face that has a corner twice
  folded,        ///< a polygon that crosses itself or is folded flat
  doubled,       ///< a triangle that is there already
  strip,         ///< a strip of triangles
  on_edge,       ///< a corner on an edge that has no vertex there
  welded,        ///< a vertex that all but lies on another one
  unused,        ///< a vertex of no face
  one_sided,     ///< where a surface closes that has one side only
};

class Mending {
 public:
  /// `place`: where, e.g. "line 12".
  void add(Fault fault, std::string place);
  /// A sentence for each kind of fault: how many there were, what became of them, and where the first are.
  std::vector<std::string> notes() const;
  bool has(Fault fault) const { return found_[static_cast<std::size_t>(fault)].count > 0; }

 private:
  struct Found {
    std::size_t count = 0;
    std::vector<std::string> places;  ///< of the first ones
  };
  static constexpr std::size_t faults = static_cast<std::size_t>(Fault::one_sided) + 1;
  std::array<Found, faults> found_;
};

}  // namespace clothlab::mesh
