// Where the meshes are that a document names: `"mesh": {"obj": NAME}`.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

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
  /// Error: there is no such mesh, or it cannot be read; `where` is its name and line.
  virtual Result<SharedMesh> mesh(const std::string& name) const = 0;
};

/// The meshes of the scenes that come with the program, "presets/NAME.obj"; an error for all other names.
Result<SharedMesh> preset_mesh(const std::string& name);

/// The .obj and .ply files below a folder. A file is read once, and again after it has changed.
class FolderAssets : public Assets {
 public:
  explicit FolderAssets(std::filesystem::path root) : root_(std::move(root)) {}
  /// `name` is a path below the folder. Refused are absolute paths, "..", other endings, what is no ordinary
  /// file, and symbolic links that lead out of the folder.
  Result<SharedMesh> mesh(const std::string& name) const override;
  /// From now on only meshes that have been read already are found, and no file is opened.
  void close();

 private:
  struct Read {
    std::filesystem::file_time_type changed;
    std::uintmax_t bytes = 0;
    SharedMesh mesh;
  };
  Result<std::filesystem::path> file_of(const std::string& name) const;

  std::filesystem::path root_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Read> read_;  ///< emptied when it holds too much
  bool closed_ = false;
};

}  // namespace clothlab::scene
