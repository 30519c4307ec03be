#include "server/session/mesh_shelf.h"

#include <algorithm>

#include "server/base/files.h"
#include "server/base/text.h"

namespace clothlab::session {

namespace fs = std::filesystem;

namespace {

const std::string mesh_title = "clothlab mesh 1\n";

mesh::Limits upload_limits() {
  mesh::Limits limits = scene::file_limits();
  limits.bytes = max_upload_bytes;
  return limits;
}

}  // namespace

std::vector<fs::path> mesh_files(const fs::path& stem) {
  const std::string begin = stem.filename().string() + ".mesh-";
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code failure;
  for (fs::directory_iterator at(stem.parent_path(), failure), end; !failure && at != end;
       at.increment(failure)) {
    const std::string name = at->path().filename().string();
    // What is unfinished, was moved aside or belongs to another session has a further ending.
    if (name.starts_with(begin) && name.find('.', begin.size()) == name.npos && at->is_regular_file(failure))
      found.emplace_back(at->last_write_time(failure), at->path());
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> files;
  for (auto& [time, file] : found) files.push_back(std::move(file));
  return files;
}

Result<scene::SharedMesh> MeshShelf::mesh(const std::string& name, const mesh::Reading& reading) const {
  SharedItem item;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = items_.find(name); found != items_.end()) item = found->second;
    if (item && reading == mesh::Reading{}) return item->mesh;
    if (item)
      if (const auto read = read_otherwise_.find({item->number, reading}); read != read_otherwise_.end())
        return read->second;
  }
  if (item) {
    Result<mesh::Mesh> mesh = mesh::read(item->bytes, name, upload_limits(), reading);
    if (!mesh) return mesh.error();
    const std::lock_guard lock(mutex_);
    if (read_otherwise_.size() >= 2 * max_meshes) read_otherwise_.clear();
    return read_otherwise_[{item->number, reading}] = std::make_shared<const mesh::Mesh>(std::move(*mesh));
  }
  if (files_) return files_->mesh(name, reading);
  return Error{name, "no such mesh",
               "the name of a mesh.upload; for files start the server with --asset-root"};
}

Result<MeshShelf::SharedItem> MeshShelf::read(const std::string& name, std::string bytes) {
  Result<mesh::Mesh> mesh = mesh::read(bytes, name, upload_limits());
  if (!mesh) return mesh.error();
  const std::lock_guard lock(mutex_);
  return std::make_shared<const Item>(
      Item{std::move(bytes), std::make_shared<const mesh::Mesh>(std::move(*mesh)), ++last_number_});
}

Result<std::vector<std::string>> MeshShelf::make_place(const std::string& name, std::size_t bytes,
                                                       const std::set<std::string>& named) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> removed;
  for (;;) {
    std::size_t total = bytes, count = 1;
    auto oldest = items_.end();
    for (auto item = items_.begin(); item != items_.end(); ++item) {
      if (item->first == name) continue;  // makes way in any case
      total += item->second->bytes.size();
      ++count;
      if (!named.contains(item->first) &&
          (oldest == items_.end() || item->second->number < oldest->second->number))
        oldest = item;
    }
    if (total <= max_mesh_bytes && count <= max_meshes) return removed;
    if (oldest == items_.end())
      return Error{
          "mesh.upload",
          std::to_string(count) + " meshes of " + std::to_string(total) + " bytes, which the scene names",
          "at most " + std::to_string(max_meshes) + " of " + std::to_string(max_mesh_bytes) +
              " bytes in a session"};
    removed.push_back(oldest->first);
    remove(oldest->first);
    items_.erase(oldest);
  }
}

MeshShelf::SharedItem MeshShelf::exchange(const std::string& name, SharedItem item) {
  const std::lock_guard lock(mutex_);
  SharedItem before;
  if (const auto found = items_.find(name); found != items_.end()) before = found->second;
  if (item)
    items_[name] = std::move(item);
  else
    items_.erase(name);
  return before;
}

/// Names may hold any characters, so that the file's name has their hash (FNV-1a).
fs::path MeshShelf::file_of(const std::string& name) const {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char byte : name) hash = (hash ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3ull;
  fs::path file = *stem_;
  file += formatted(".mesh-%016llx", static_cast<unsigned long long>(hash));
  return file;
}

void MeshShelf::remove(const std::string& name) {
  std::error_code ignored;
  if (stem_) fs::remove(file_of(name), ignored);
}

clothlab::Status MeshShelf::keep(const std::string& name) {
  SharedItem item;
  {
    const std::lock_guard lock(mutex_);
    unkept_.erase(name);
    if (const auto found = items_.find(name); found != items_.end()) item = found->second;
  }
  if (!item) remove(name);
  if (!stem_ || !item) return ok();
  clothlab::Status written = replace_file(file_of(name), mesh_title + name + "\n" + item->bytes);
  if (written) return written;
  const std::lock_guard lock(mutex_);
  unkept_.insert(name);
  return written;
}

clothlab::Status MeshShelf::keep_rest() {
  std::set<std::string> names;
  {
    const std::lock_guard lock(mutex_);
    names = unkept_;
  }
  for (const std::string& name : names)
    if (clothlab::Status kept = keep(name); !kept) return kept;
  return ok();
}

void MeshShelf::leave_files() {
  const std::lock_guard lock(mutex_);
  stem_.reset();
}

std::vector<Error> MeshShelf::restore() {
  std::vector<Error> errors;
  if (!stem_) return errors;
  std::size_t restored = 0;  // others' files, whose number is not ours, must push out no mesh
  for (const fs::path& file : mesh_files(*stem_)) {
    std::error_code failure;
    if (fs::file_size(file, failure) > max_upload_bytes + 1024) {
      errors.push_back(move_aside(file, "it is larger than an upload may be").why);
      continue;
    }
    const Result<std::string> bytes = read_file(file);
    const std::size_t end =
        bytes && bytes->starts_with(mesh_title) ? bytes->find('\n', mesh_title.size()) : std::string::npos;
    if (end == std::string::npos) {
      errors.push_back(move_aside(file, bytes ? "it is no uploaded mesh" : bytes.error().what).why);
      continue;
    }
    if (restored == max_meshes) continue;
    const std::string name = bytes->substr(mesh_title.size(), end - mesh_title.size());
    Result<SharedItem> item = read(name, bytes->substr(end + 1));
    restored += item ? 1 : 0;
    if (item)
      exchange(name, *item);
    else
      errors.push_back(move_aside(file, item.error().text()).why);
  }
  return errors;
}

}  // namespace clothlab::session
