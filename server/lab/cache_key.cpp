// Computes the key under which a result of the lab is cached: a hash of all that the result depends on.
#include <algorithm>
#include <vector>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/base/text.h"
#include "server/lab/cache.h"
#include "server/scene/method.h"
#include "server/scene/named_fabric.h"

namespace clothlab::lab {

namespace fs = std::filesystem;

namespace {

/// A hash of 128 bits from two lanes of 64 bits: FNV-1a, and a variant of it. It does not withstand an
/// attacker, who would gain nothing from a collision.
class Hash {
 public:
  void add(const std::string& bytes) {
    for (const char byte : bytes) {
      const auto value = static_cast<std::uint8_t>(byte);
      first_ = (first_ ^ value) * 0x100000001b3ull;
      // A different multiplier, so that bytes that collide in one lane do not collide in the other.
      second_ = (second_ + value + 1) * 0x9e3779b97f4a7c15ull;
      second_ ^= second_ >> 32;
    }
    // The length is hashed too, so that "ab", "c" and "a", "bc" give different hashes.
    first_ = (first_ ^ bytes.size()) * 0x100000001b3ull;
    second_ = (second_ ^ bytes.size()) * 0x9e3779b97f4a7c15ull;
  }
  std::string text() const {
    return formatted("%016llx%016llx", static_cast<unsigned long long>(first_),
                     static_cast<unsigned long long>(second_));
  }

 private:
  std::uint64_t first_ = 0xcbf29ce484222325ull, second_ = 0x84222325cbf29ce4ull;
};

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

/// The scene without what does not change the motion: names, colours and textures.
json without_appearance(json scene) {
  scene.erase("name");
  for (json& cloth : scene["cloths"])
    for (const char* key : {"name", "color", "texture"}) cloth.erase(key);
  for (json& collider : scene["colliders"]) collider.erase("name");
  return scene;
}

/// What the document does not contain: the meshes that it names.
void add_named_meshes(Hash& hash, const scene::Scene& scene) {
  const auto add = [&](const auto& list) {
    hash.add(std::string(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(list[0])));
  };
  for (const scene::Cloth& cloth : scene.cloths) {
    const auto* mesh = std::get_if<scene::TriangleMesh>(&cloth.mesh);
    if (!mesh || mesh->vertex_of.empty()) continue;
    add(mesh->vertices);
    add(mesh->triangles);
    add(mesh->pattern);
  }
  for (const scene::Collider& collider : scene.colliders) {
    const auto* body = std::get_if<scene::Body>(&collider.shape);
    if (!body) continue;
    add(body->mesh->vertices);
    add(body->mesh->triangles);
  }
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
  hash.add(without_appearance(scene::spelled_out(document)).dump());
  add_named_meshes(hash, document.scene);
  return {hash.text(), document.scene.name};
}

}  // namespace clothlab::lab
