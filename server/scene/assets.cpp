#include "server/scene/assets.h"

#include <algorithm>
#include <cctype>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/scene/document.h"
#include "server/scene/ranges.h"

namespace clothlab::scene {

namespace fs = std::filesystem;

mesh::Limits file_limits() {
  return {max_file_bytes, max_vertices, max_triangles};
}

namespace {

/// Empty if `name` could be that of a file below a folder, else what is wrong with it.
std::string bad_name(const std::string& name) {
  constexpr std::size_t longest = 255;
  if (name.empty() || name.size() > longest) return std::to_string(name.size()) + " bytes of name";
  if (std::any_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; }))
    return "a name with a control character";
  const fs::path path(name);
  if (path.is_absolute()) return "an absolute path";
  for (const fs::path& part : path)
    if (part == ".." || part == "." || part.empty()) return "a path with \"" + part.string() + "\" in it";
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending != ".obj" && ending != ".ply") return "a name that ends in neither .obj nor .ply";
  return "";
}

}  // namespace

Result<fs::path> FolderAssets::file_of(const std::string& name) const {
  const std::string allowed = "an .obj or .ply file by its path below the folder of meshes (--asset-root)";
  if (const std::string wrong = bad_name(name); !wrong.empty()) return Error{name, wrong, allowed};
  std::error_code failure;
  const fs::path root = fs::canonical(root_, failure);
  const fs::path file = failure ? fs::path() : fs::canonical(root / name, failure);
  if (failure) return Error{name, "no such file", allowed};
  if (std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first != root.end())
    return Error{name, "a symbolic link that leads out of the folder of meshes", allowed};
  if (!fs::is_regular_file(file, failure)) return Error{name, "no ordinary file", allowed};
  return file;
}

Result<SharedMesh> FolderAssets::mesh(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto known = read_.find(name);
  if (closed_) {
    if (known != read_.end()) return known->second.mesh;
    return Error{name, "no mesh of the scene that the server was started with",
                 "the name of a mesh.upload; for other files start the server with --asset-root"};
  }
  const Result<fs::path> file = file_of(name);
  if (!file) return file.error();
  std::error_code failure;
  Read read{fs::last_write_time(*file, failure), fs::file_size(*file, failure), nullptr};
  if (failure) return Error{name, "cannot be read", "a file that this user may read"};
  if (known != read_.end() && known->second.changed == read.changed && known->second.bytes == read.bytes)
    return known->second.mesh;
  if (read.bytes > max_file_bytes)
    return Error{name, std::to_string(read.bytes) + " bytes", "at most " + std::to_string(max_file_bytes)};
  const Result<std::string> bytes = read_file(*file);
  if (!bytes) return Error{name, bytes.error().what, bytes.error().remedy};
  Result<mesh::Mesh> mesh = mesh::read(*bytes, name, file_limits());
  if (!mesh) return mesh.error();
  read.mesh = std::make_shared<const mesh::Mesh>(std::move(*mesh));
  std::uintmax_t total = read.bytes;
  for (const auto& [other, earlier] : read_) total += earlier.bytes;
  if (total > 2 * max_file_bytes) read_.clear();
  return (read_[name] = std::move(read)).mesh;
}

Result<SharedMesh> preset_mesh(const std::string& name) {
  if (name.rfind("presets/", 0) != 0) return Error{name, "no mesh of a preset", "presets/NAME.obj"};
  static const Result<fs::path> presets = data_path("server/scene/presets");
  if (!presets) return presets.error();
  static const FolderAssets own(presets->parent_path());
  return own.mesh(name);
}

void FolderAssets::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

}  // namespace clothlab::scene
