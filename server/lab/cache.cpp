#include "server/lab/cache.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "server/base/files.h"
#include "server/lab/exports.h"

namespace clothlab::lab {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t most_bytes_a_file = 16 * 1024 * 1024;
constexpr const char* suffix = ".json";

bool complete(const Outcome& outcome) {
  return std::visit([](const auto& result) { return result.complete; }, outcome);
}

/// The result with the scene's present name in the place of the one it was measured under.
Outcome named(Outcome outcome, const std::string& scene) {
  std::visit([&](auto& result) { result.scene = scene; }, outcome);
  return outcome;
}

}  // namespace

std::optional<Outcome> Cache::find(const CacheKey& key) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(recent_.begin(), recent_.end(),
                                  [&](const Entry& entry) { return entry.hash == key.hash; });
  if (found != recent_.end()) {
    recent_.splice(recent_.begin(), recent_, found);
    return named(recent_.front().outcome, key.scene);
  }
  std::optional<Outcome> outcome = read(key.hash);
  if (!outcome) return std::nullopt;
  remember(key.hash, *outcome);
  return named(*outcome, key.scene);
}

void Cache::keep(const CacheKey& key, const Outcome& outcome) {
  if (!complete(outcome)) return;
  const std::lock_guard lock(mutex_);
  std::erase_if(recent_, [&](const Entry& entry) { return entry.hash == key.hash; });
  remember(key.hash, outcome);
  write(key.hash, outcome);
}

void Cache::remember(const std::string& hash, const Outcome& outcome) {
  recent_.push_front({hash, outcome});
  while (recent_.size() > limits_.entries_in_memory) recent_.pop_back();
}

std::optional<Outcome> Cache::read(const std::string& hash) const {
  if (folder_.empty()) return std::nullopt;
  const fs::path path = folder_ / (hash + suffix);
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) return std::nullopt;
  if (const std::uintmax_t bytes = fs::file_size(path, failure); failure || bytes > most_bytes_a_file)
    return std::nullopt;
  const Result<std::string> text = read_file(path);
  if (!text) return std::nullopt;
  // The file is not trusted, as any program may write to the folder: depth and size are limited, and bad JSON
  // is an Error.
  const Result<json> file = scene::parse_json(*text, path.string(), false, {most_bytes_a_file});
  if (!file || !file->is_object() || !file->contains("key") || !file->contains("result") ||
      file->at("key") != hash)
    return std::nullopt;
  const Result<Outcome> outcome = from_json(file->at("result"));
  if (!outcome || !complete(*outcome)) return std::nullopt;
  return *outcome;
}

void Cache::write(const std::string& hash, const Outcome& outcome) const {
  if (folder_.empty()) return;
  std::error_code failure;
  fs::create_directories(folder_, failure);
  const std::string text =
      json{{"key", hash}, {"result", to_json(outcome)}}.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > most_bytes_a_file) return;
  // A folder that cannot be written is no error: the result is measured again next time.
  if (!replace_file(folder_ / (hash + suffix), text)) return;
  remove_oldest();
}

void Cache::remove_oldest() const {
  struct File {
    fs::path path;
    fs::file_time_type written;
    std::uintmax_t bytes;
  };
  std::vector<File> files;
  std::uintmax_t bytes = 0;
  std::error_code failure;
  for (fs::directory_iterator at(folder_, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code gone;  // set if another program has deleted the file meanwhile
    const std::string extension = at->path().extension().string();
    if (extension != suffix && extension != unfinished_suffix) continue;
    File file{at->path(), at->last_write_time(gone), at->file_size(gone)};
    if (gone) continue;
    bytes += file.bytes;
    files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const File& one, const File& other) { return one.written < other.written; });
  for (const File& file : files) {
    if (bytes <= limits_.bytes_on_disk) return;
    fs::remove(file.path, failure);
    bytes -= file.bytes;
  }
}

}  // namespace clothlab::lab
