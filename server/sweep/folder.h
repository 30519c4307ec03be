// The folder of a sweep: sweep.json, and below points/ a file for each point that is done. A file is there
// whole or not at all, so that shards on many machines may share the folder, and a call that was cut short
// goes on where it was.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/sweep/measure.h"
#include "server/sweep/plan.h"

namespace clothlab::sweep {

class Folder {
 public:
  /// Makes the folder if needed, and keeps the sweep's file in it. Error: it cannot be written, or another
  /// sweep is in it.
  static Result<Folder> open(const std::filesystem::path& path, const Plan& plan);
  /// A folder of a sweep that was begun before, and its plan. Error: there is none, or it is damaged.
  static Result<std::pair<Folder, Plan>> find(const std::filesystem::path& path,
                                              const std::shared_ptr<const scene::Assets>& meshes);

  /// The result of the point `id`. None: it is not done, or its file is damaged.
  std::optional<Row> result(const std::string& id) const;
  bool has(const std::string& id) const { return result(id).has_value(); }
  Status keep(const std::string& id, const Measured& measured) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit Folder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path file(const std::string& id, const char* extension) const;

  std::filesystem::path path_;
};

}  // namespace clothlab::sweep
