// Computes the key under which a result of the lab is cached: a hash of all that the result depends on.
#include <algorithm>
#include <vector>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/base/hash.h"
#include "server/lab/cache.h"
#include "server/lab/scene_hash.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace fs = std::filesystem;

namespace {

/// A hash of the program's file and of the shaders that it compiles while it runs.
std::string build_hash() {
  Hash hash;
  if (const Result<std::string> program = read_file("/proc/self/exe")) hash.add(*program);
  const Result<fs::path> shaders = data_path("shaders");
  std::vector<fs::path> files;
  std::error_code failure;
  if (shaders)
    for (fs::recursive_directory_iterator at(*shaders, failure), end; !failure && at != end;
         at.increment(failure))
      if (at->is_regular_file(failure)) files.push_back(at->path());
  std::sort(files.begin(), files.end());  // the order of a folder's entries is not defined
  for (const fs::path& file : files) {
    hash.add(fs::relative(file, *shaders, failure).string());
    if (const Result<std::string> text = read_file(file)) hash.add(*text);
  }
  return hash.text();
}

/// The names of `methods` (empty: of all), sorted, as their order does not change a result.
json names(std::vector<scene::Method> methods) {
  if (methods.empty()) methods.assign(scene::methods.begin(), scene::methods.end());
  std::sort(methods.begin(), methods.end());
  json list = json::array();
  for (const scene::Method method : methods) list.push_back(scene::name(method));
  return list;
}

json maybe(const std::optional<double>& value) {
  return value ? json(*value) : json();
}

json of(const ChartRequest& request) {
  return {{"methods", names(request.methods)},
          {"iterations", request.iterations},
          {"time", maybe(request.time)},
          {"budget", request.budget}};
}
json of(const MapRequest& request) {
  return {{"methods", names(request.methods)},
          {"field", request.field},
          {"from", maybe(request.from)},
          {"to", maybe(request.to)},
          {"columns", request.columns}};
}
json of(const ChooseRequest& request) {
  return {
      {"tolerance", request.tolerance}, {"methods", names(request.methods)}, {"time", maybe(request.time)}};
}
json of(const SimplifyRequest& request) {
  return {{"tolerance", request.tolerance}, {"time", maybe(request.time)}};
}
json of(const CompareRequest& request) {
  return {{"patch", request.patch}, {"truth", request.truth}, {"time", request.time}, {"rate", request.rate}};
}

}  // namespace

CacheKey cache_key(const scene::Document& document, const Job& job, const std::string& renderer) {
  static const std::string build = build_hash();
  Hash hash;
  hash.add(build);
  hash.add(renderer);
  hash.add(name(job));
  hash.add(std::visit([](const auto& request) { return of(request); }, job).dump());
  add_scene(hash, document);
  return {hash.text(), document.scene.name};
}

}  // namespace clothlab::lab
