// Reads fabrics.json, with the same checks as a scene.
#include "server/scene/fabrics.h"

#include <filesystem>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/scene/document.h"
#include "server/scene/sections.h"

namespace clothlab::scene {

namespace {

constexpr std::size_t max_fabrics = 256;
const char* const fabrics_file = "server/scene/fabrics.json";

std::optional<Fabric::Locks> read_locks(const Reader& locks) {
  if (locks.is_null()) return std::nullopt;
  locks.object({"warp", "weft"});
  return Fabric::Locks{locks.member("warp").number(ranges::strain_limit),
                       locks.member("weft").number(ranges::strain_limit)};
}

Fabric read_fabric(const Reader& fabric) {
  fabric.object({"name", "feel", "area_density", "material", "locks_at", "source"});
  const std::string sentence = "a sentence";
  return {fabric.member("name").name(),
          fabric.member("feel").string(sentence),
          fabric.member("source").string(sentence),
          fabric.member("area_density").number(ranges::area_density),
          read_sheet(fabric.member("material"), nullptr),
          read_locks(fabric.member("locks_at"))};
}

Result<std::vector<Fabric>> read_fabrics() {
  const Result<std::filesystem::path> path = data_path(fabrics_file);
  if (!path) return path.error();
  const Result<std::string> text = read_file(*path);
  if (!text) return text.error();
  Result<json> value = parse_json(*text, path->string(), true);
  if (!value) return value.error();
  std::optional<Error> error;
  const Reader list(&*value, "", error);
  std::vector<Fabric> read(list.array(1, max_fabrics));
  for (std::size_t i = 0; i < read.size(); ++i) read[i] = read_fabric(list.element(i));
  if (!error) return read;
  return Error{path->string() + ": " + error->where, error->what, error->remedy};
}

}  // namespace

const Result<std::vector<Fabric>>& fabrics() {
  static const Result<std::vector<Fabric>> all = read_fabrics();
  return all;
}

}  // namespace clothlab::scene
