// Keeps results of the lab, so that the same scene, job, build and device give the same answer without
// measuring again: in memory, and on disk for other runs of the program. A disk that cannot be written is no
// error, and a file that is damaged or was not written by this program is ignored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <mutex>
#include <optional>
#include <string>

#include "server/base/cache_folder.h"
#include "server/lab/job.h"

namespace clothlab::lab {

/// Identifies a result by all that it depends on.
struct CacheKey {
  std::string hash;   ///< 32 hexadecimal digits, from the scene without its names, colours and textures, the
                      ///< job, the program and its shaders, and the renderer
  std::string scene;  ///< the scene's name: put into a result that is found, but no part of the hash
};
/// `renderer`: gl::renderer_name() of the context the job would run in.
CacheKey cache_key(const scene::Document& document, const Job& job, const std::string& renderer);

/// All functions may be called from any thread, and several programs may use one folder.
class Cache {
 public:
  struct Limits {
    std::size_t entries_in_memory = 64;
    std::uintmax_t bytes_on_disk = 64 * 1024 * 1024;
  };

  /// Where `folder` is empty or cannot be written, results are kept in memory only.
  explicit Cache(std::filesystem::path folder = cache_folder("lab")) : Cache(std::move(folder), Limits{}) {}
  Cache(std::filesystem::path folder, Limits limits) : folder_(std::move(folder)), limits_(limits) {}

  std::optional<Outcome> find(const CacheKey& key);
  /// Keeps `outcome` if it is complete. Where there is no room, the oldest results are deleted.
  void keep(const CacheKey& key, const Outcome& outcome);

 private:
  struct Entry {
    std::string hash;
    Outcome outcome;
  };
  void remember(const std::string& hash, const Outcome& outcome);
  std::optional<Outcome> read(const std::string& hash) const;
  void write(const std::string& hash, const Outcome& outcome) const;
  void remove_oldest() const;

  std::filesystem::path folder_;
  Limits limits_;
  std::mutex mutex_;
  std::list<Entry> recent_;  ///< the most recently used first
};

}  // namespace clothlab::lab
