// The kinds of files that a film can be written as, for other programs. A writer goes through the frames in
// their order and hands on the bytes of the file in theirs, so that a file may be larger than the memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/film/film.h"

namespace clothlab::film {

/// Gets the bytes of the file, piece by piece.
using Put = std::function<Status(std::string_view)>;

/// A binary glTF file: each cloth a mesh whose frames are morph targets, each body a node that moves.
Status write_glb(const Film& film, const Put& put);
/// A USD stage as text, with time samples.
Status write_usda(const Film& film, const Put& put);
/// The places of all cloths' vertices, without bodies: a point cache for the mesh of `write_obj`.
Status write_pc2(const Film& film, const Put& put);

/// A kind of file that is one stream of bytes.
struct Format {
  std::string ending;  ///< ".glb"
  const char* content_type;
  std::uint32_t most_frames;  ///< 0: any number
  Status (*write)(const Film&, const Put&);
  /// Estimates its size.
  std::uint64_t (*bytes)(std::uint64_t frames, std::uint64_t vertices);
};
std::span<const Format> formats();
/// Null: there is none that ends so.
const Format* format_of(const std::string& ending);
/// True of the endings in `formats()`, and of ".obj".
bool is_film(const std::string& ending);
/// Error: a film of so many frames cannot be such a file. Files of any other ending have no limits.
Status check_size(const std::string& ending, std::uint64_t frames, std::uint64_t vertices);

/// What `write_files` has made.
struct Written {
  std::string names;        ///< in words
  std::uint64_t bytes = 0;  ///< of all files
};
/// Writes the film to the file `path`, of a kind in `formats()`, or ".obj": then a file a frame, PATH with
/// -0000, -0001, ... before its ending. Beside a .pc2 it writes the mesh, `mesh_beside`.
Result<Written> write_files(const Film& film, const std::string& path);
/// The same path with the ending .obj.
std::string mesh_beside(const std::string& path);

}  // namespace clothlab::film
