// Where the meshes are that a document names: `"mesh": {"file": NAME}`.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/base/result.h"
#include "server/mesh/mesh.h"

namespace clothlab::scene {

using SharedMesh = std::shared_ptr<const mesh::Mesh>;

/// The limits of a mesh's file [bytes], vertices and triangles.
mesh::Limits file_limits();

/// Any thread may call it, as documents travel between threads.
class Assets {
 public:
  virtual ~Assets() = default;
  /// Error: there is no such mesh, or it cannot be read so; `where` is its name and line.
  virtual Result<SharedMesh> mesh(const std::string& name, const mesh::Reading& reading) const = 0;
};

/// The meshes of the scenes that come with the program, "presets/NAME.obj"; an error for all other names.
Result<SharedMesh> preset_mesh(const std::string& name, const mesh::Reading& reading);

/// The files of meshes below a folder. A file is read once in each way, and again after it, or what it names,
/// has changed.
class FolderAssets : public Assets {
 public:
  explicit FolderAssets(std::filesystem::path root) : root_(std::move(root)) {}
  /// `name` is a path below the folder. Refused are absolute paths, "..", other endings, what is no ordinary
  /// file, and symbolic links that lead out of the folder.
  Result<SharedMesh> mesh(const std::string& name, const mesh::Reading& reading) const override;
  /// From now on only meshes that have been read already are found, and no other file is opened.
  void close();

 private:
  /// A file as it was when it was read.
  struct Stamp {
    std::filesystem::path file;
    std::filesystem::file_time_type changed;
    std::uintmax_t bytes = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Read {
    std::vector<Stamp> files;  ///< the mesh's own, and those that it names
    SharedMesh mesh;
  };
  using Key = std::pair<std::string, mesh::Reading>;
  /// `allowed`: for the error; `endings`: those that the name may have.
  Result<std::filesystem::path> file_of(const std::string& name, const std::vector<std::string>& endings,
                                        const std::string& allowed) const;
  static Result<Stamp> stamp_of(const std::filesystem::path& file, const std::string& name);
  static bool unchanged(const Read& read);
  Result<Read> read(const std::string& name, const mesh::Reading& reading) const;

  std::filesystem::path root_;
  mutable std::mutex mutex_;
  mutable std::map<Key, Read> read_;  ///< emptied when it holds too much
  bool closed_ = false;
};

}  // namespace clothlab::scene
