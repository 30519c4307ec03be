// The meshes that operators have uploaded to a session (mesh.upload), beside the files of the server. Their
// number and size are bounded: to make room, the oldest that the scene does not name is removed. With a
// folder each is kept in a file of its own. It outlives the session's thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/scene/assets.h"

namespace clothlab::session {

inline constexpr std::size_t max_upload_bytes = 8 * 1024 * 1024;  ///< of one message with a mesh
inline constexpr std::size_t max_meshes = 16;                     ///< uploaded, of one session
inline constexpr std::size_t max_mesh_bytes = 32 * 1024 * 1024;   ///< of all of them together
inline constexpr std::size_t max_mesh_name_bytes = 64;            ///< of the name of one

/// The files of the meshes that a shelf with this stem has kept, the oldest first.
std::vector<std::filesystem::path> mesh_files(const std::filesystem::path& stem);

class MeshShelf : public scene::Assets {
 public:
  struct Item {
    std::string bytes;         ///< of the file
    scene::SharedMesh mesh;    ///< read as a file is unless a scene says otherwise
    std::uint64_t number = 0;  ///< rises with every upload
  };
  using SharedItem = std::shared_ptr<const Item>;

  /// `files` (may be null) has the meshes that were not uploaded. `stem` is the path of the files to keep,
  /// each with an ending of its own; none: uploads are not kept.
  explicit MeshShelf(std::shared_ptr<const scene::Assets> files = nullptr,
                     std::optional<std::filesystem::path> stem = std::nullopt)
      : files_(std::move(files)), stem_(std::move(stem)) {}

  /// An uploaded mesh comes before a file of the same name.
  Result<scene::SharedMesh> mesh(const std::string& name, const mesh::Reading& reading) const override;

  /// Reads the bytes of a file. Error: it is no mesh, or larger than an upload may be.
  Result<SharedItem> read(const std::string& name, std::string bytes);
  /// Removes the oldest meshes that are not in `named` until one more of `bytes` fits, and returns their
  /// names. Error: all that are left are named.
  Result<std::vector<std::string>> make_place(const std::string& name, std::size_t bytes,
                                              const std::set<std::string>& named);
  /// Puts a mesh in the place of the one of this name (null: none), and returns that one.
  SharedItem exchange(const std::string& name, SharedItem item);

  /// Writes the mesh of this name into its file, if there is a folder; without such a mesh there is no file.
  clothlab::Status keep(const std::string& name);
  /// Writes the meshes that `keep` could not write. Error: the first that still cannot be written.
  clothlab::Status keep_rest();
  /// Reads the files of an earlier server. Returns what was wrong with those that could not be read, and
  /// where they were moved to: FILE.unreadable, with a number behind it if there is one.
  std::vector<Error> restore();
  /// From now on no file is written or removed: those that are there belong to what could not be restored.
  void leave_files();

 private:
  std::filesystem::path file_of(const std::string& name) const;
  void remove(const std::string& name);

  std::shared_ptr<const scene::Assets> files_;
  std::optional<std::filesystem::path> stem_;
  mutable std::mutex mutex_;
  std::map<std::string, SharedItem> items_;
  /// Uploads that scenes have read in another way, by number; emptied when they are many.
  mutable std::map<std::pair<std::uint64_t, mesh::Reading>, scene::SharedMesh> read_otherwise_;
  std::set<std::string> unkept_;  ///< names of meshes that could not be written
  std::uint64_t last_number_ = 0;
};

}  // namespace clothlab::session
