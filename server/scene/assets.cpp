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

const std::vector<std::string> mesh_endings{".obj", ".ply", ".glb", ".gltf"};
const std::vector<std::string> buffer_endings{".bin", ".glbin", ".glbuf"};

/// ".obj, .ply or .glb".
std::string in_words(const std::vector<std::string>& endings) {
  std::string words;
  for (std::size_t i = 0; i < endings.size(); ++i)
    words += (i == 0 ? "" : i + 1 == endings.size() ? " or " : ", ") + endings[i];
  return words;
}

/// Empty if `name` could be that of a file below a folder, else what is wrong with it.
std::string bad_name(const std::string& name, const std::vector<std::string>& endings) {
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
  if (std::find(endings.begin(), endings.end(), ending) == endings.end())
    return "a name that does not end in " + in_words(endings);
  return "";
}

}  // namespace

Result<fs::path> FolderAssets::file_of(const std::string& name, const std::vector<std::string>& endings,
                                       const std::string& allowed) const {
  if (const std::string wrong = bad_name(name, endings); !wrong.empty()) return Error{name, wrong, allowed};
  std::error_code failure;
  const fs::path root = fs::canonical(root_, failure);
  const fs::path file = failure ? fs::path() : fs::canonical(root / name, failure);
  if (failure) return Error{name, "no such file", allowed};
  if (std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first != root.end())
    return Error{name, "a symbolic link that leads out of the folder of meshes", allowed};
  if (!fs::is_regular_file(file, failure)) return Error{name, "no ordinary file", allowed};
  return file;
}

Result<FolderAssets::Stamp> FolderAssets::stamp_of(const fs::path& file, const std::string& name) {
  std::error_code failure;
  Stamp stamp{file, fs::last_write_time(file, failure), fs::file_size(file, failure)};
  if (failure) return Error{name, "cannot be read", "a file that this user may read"};
  if (stamp.bytes > max_file_bytes)
    return Error{name, std::to_string(stamp.bytes) + " bytes", "at most " + std::to_string(max_file_bytes)};
  return stamp;
}

bool FolderAssets::unchanged(const Read& read) {
  return std::all_of(read.files.begin(), read.files.end(), [](const Stamp& stamp) {
    const Result<Stamp> now = stamp_of(stamp.file, "");
    return now && *now == stamp;
  });
}

Result<FolderAssets::Read> FolderAssets::read(const std::string& name, const mesh::Reading& reading) const {
  Read read;
  const auto open = [&](const Result<fs::path>& file, const std::string& named) -> Result<std::string> {
    if (!file) return file.error();
    Result<Stamp> stamp = stamp_of(*file, named);
    if (!stamp) return stamp.error();
    Result<std::string> bytes = read_file(*file);
    if (!bytes) return Error{named, bytes.error().what, bytes.error().remedy};
    read.files.push_back(std::move(*stamp));
    return bytes;
  };
  const Result<std::string> bytes =
      open(file_of(name, mesh_endings,
                   "a file (" + in_words(mesh_endings) +
                       ") by its path below the folder of meshes (--asset-root)"),
           name);
  if (!bytes) return bytes.error();
  const auto beside = [&](const std::string& other) -> Result<std::string> {
    const std::string path = (fs::path(name).parent_path() / other).string();
    return open(file_of(path, buffer_endings, "a file (" + in_words(buffer_endings) + ") beside " + name),
                path);
  };
  Result<mesh::Mesh> mesh = mesh::read(*bytes, name, file_limits(), reading, beside);
  if (!mesh) return mesh.error();
  read.mesh = std::make_shared<const mesh::Mesh>(std::move(*mesh));
  return read;
}

Result<SharedMesh> FolderAssets::mesh(const std::string& name, const mesh::Reading& reading) const {
  const std::lock_guard lock(mutex_);
  const auto known = read_.find({name, reading});
  if (known != read_.end() && (closed_ || unchanged(known->second))) return known->second.mesh;
  // The scene's own file may still be read in another way.
  if (closed_ &&
      std::none_of(read_.begin(), read_.end(), [&](const auto& other) { return other.first.first == name; }))
    return Error{name, "no mesh of the scene that the server was started with",
                 "the name of a mesh.upload; for other files start the server with --asset-root"};
  Result<Read> fresh = read(name, reading);
  if (!fresh) return fresh.error();
  std::uintmax_t total = 0;
  for (const auto& [key, other] : read_)
    for (const Stamp& stamp : other.files) total += stamp.bytes;
  for (const Stamp& stamp : fresh->files) total += stamp.bytes;
  if (total > 2 * max_file_bytes && !closed_) read_.clear();
  return (read_[{name, reading}] = std::move(*fresh)).mesh;
}

Result<SharedMesh> preset_mesh(const std::string& name, const mesh::Reading& reading) {
  if (name.rfind("presets/", 0) != 0) return Error{name, "no mesh of a preset", "presets/NAME.obj"};
  static const Result<fs::path> presets = data_path("server/scene/presets");
  if (!presets) return presets.error();
  static const FolderAssets own(presets->parent_path());
  return own.mesh(name, reading);
}

void FolderAssets::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

}  // namespace clothlab::scene
