#include "server/sweep/folder.h"

#include <system_error>

#include "server/base/files.h"

namespace clothlab::sweep {

namespace fs = std::filesystem;

namespace {

constexpr const char* plan_file = "sweep.json";

template <class Json>
std::string text_of(const Json& value) {
  return value.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Result<Folder> Folder::open(const fs::path& path, const Plan& plan) {
  std::error_code failure;
  fs::create_directories(path, failure);
  if (!fs::is_directory(path, failure))
    return Error{"--out " + path.string(), "is no folder and cannot be made one", "name another folder"};
  const fs::path file = path / plan_file;
  if (!fs::exists(file, failure)) {
    if (Status written = replace_file(file, text_of(plan.file)); !written) return written.error();
    return Folder(path);
  }
  const Result<std::string> present = read_file(file);
  if (!present) return present.error();
  if (json::parse(*present, nullptr, false) != plan.file)
    return Error{"--out " + path.string(), "another sweep is in it, which its sweep.json describes",
                 "name another folder, or take that sweep.json as the file of the sweep"};
  return Folder(path);
}

Result<std::pair<Folder, Plan>> Folder::find(const fs::path& path,
                                             const std::shared_ptr<const scene::Assets>& meshes) {
  std::error_code failure;
  if (!fs::exists(path / plan_file, failure))
    return Error{path.string(), "has no sweep.json", "name the folder that a sweep wrote with --out"};
  Result<Plan> plan = read_plan((path / plan_file).string(), meshes);
  if (!plan) return plan.error();
  return std::pair(Folder(path), std::move(*plan));
}

/// In one of 256 folders: file systems become slow with a million names in one.
fs::path Folder::file(const std::string& id, const char* extension) const {
  return path_ / "points" / id.substr(0, 2) / (id + extension);
}

std::optional<Row> Folder::result(const std::string& id) const {
  std::error_code failure;
  const fs::path path = file(id, ".json");
  if (!fs::exists(path, failure)) return std::nullopt;
  const Result<std::string> text = read_file(path);
  if (!text) return std::nullopt;
  Row value = Row::parse(*text, nullptr, false);
  if (!value.is_object() || !value.contains("id") || value["id"] != id) return std::nullopt;
  return value;
}

Status Folder::keep(const std::string& id, const Measured& measured) const {
  std::error_code failure;
  const fs::path folder = file(id, "").parent_path();
  fs::create_directories(folder, failure);
  if (failure)
    return Error{folder.string(), "could not be made: " + failure.message(),
                 "check the disk's space and the folder's permissions"};
  // First the mesh: whoever finds the result finds it, too.
  if (!measured.shape.empty())
    if (Status written = replace_file(file(id, ".ply"), measured.shape); !written) return written;
  Row result = measured.result;
  result["id"] = id;
  return replace_file(file(id, ".json"), text_of(result));
}

}  // namespace clothlab::sweep
