#include "server/gl/device_fact.h"

#include <glad/gl.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>

#include "server/base/cache_folder.h"
#include "server/base/files.h"
#include "server/base/hash.h"
#include "server/base/text.h"
#include "server/gl/context.h"

namespace clothlab::gl {

namespace fs = std::filesystem;

namespace {

/// All that a fact depends on, as a line of text.
std::string description(const std::string& name) {
  std::string text = name + ", least of several rounds, of " + renderer_name() + ", " +
                     reinterpret_cast<const char*>(glGetString(GL_VERSION));
  if (software_renderer()) text += ", " + what_computes();
  return text;
}

fs::path file_of(const std::string& about) {
  const fs::path folder = cache_folder("devices");
  if (folder.empty()) return {};
  Hash hash;
  hash.add(about);
  return folder / hash.text();
}

/// The file's lines are the description and the number.
std::optional<double> read(const fs::path& path, const std::string& about) {
  std::error_code failure;
  if (path.empty() || !fs::is_regular_file(path, failure)) return std::nullopt;
  std::ifstream file(path);
  std::string line, number;
  if (!std::getline(file, line) || line != about || !std::getline(file, number)) return std::nullopt;
  double value = 0.0;
  const auto [end, wrong] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (wrong != std::errc() || end != number.data() + number.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// A folder that cannot be written is no error: the fact is measured again next time.
void write(const fs::path& path, const std::string& about, double value) {
  if (path.empty()) return;
  std::error_code failure;
  fs::create_directories(path.parent_path(), failure);
  (void)replace_file(path, about + "\n" + with_significant_digits(value, 6) + "\n");
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// [s], from queuing to the device's end of it.
double time_of(const std::function<void(int)>& work, int times) {
  const double start = seconds();
  work(times);
  glFinish();
  return seconds() - start;
}

}  // namespace

double device_fact(const std::string& name, const std::function<double()>& measure) {
  static std::recursive_mutex mutex;
  static std::map<std::string, double> known;
  const std::lock_guard lock(mutex);
  const std::string about = description(name);
  if (const auto found = known.find(about); found != known.end()) return found->second;
  const fs::path path = file_of(about);
  std::optional<double> value = read(path, about);
  if (!value) {
    value = measure();
    write(path, about, *value);
  }
  return known[about] = *value;
}

TwoTimes time_in_turn(const std::function<void(int)>& one, const std::function<void(int)>& other) {
  constexpr double enough = 1e-3;  // [s]
  constexpr int rounds = 7, most_times = 4096;
  for (const auto* work : {&one, &other}) time_of(*work, 1);  // compiles
  int times = 1;
  while (time_of(one, times) < enough && times < most_times) times *= 2;
  TwoTimes least{time_of(one, times), time_of(other, times)};
  for (int round = 1; round < rounds; ++round) {
    least.one = std::min(least.one, time_of(one, times));
    least.other = std::min(least.other, time_of(other, times));
  }
  return {least.one / times, least.other / times};
}

}  // namespace clothlab::gl
