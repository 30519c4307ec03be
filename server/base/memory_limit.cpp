#include "server/base/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

namespace clothlab {

namespace {

using std::filesystem::path;

/// The number in a group's file; none: "max", or there is no such file.
std::optional<std::uint64_t> number_in(const path& file) {
  std::uint64_t value = 0;
  if (std::ifstream(file) >> value) return value;
  return std::nullopt;
}

/// The least number in the files of this name from the folder `group` below `root` up to `root`.
std::optional<std::uint64_t> least_up(const path& root, const path& group, const char* name) {
  std::optional<std::uint64_t> least = number_in(root / name);
  path below = root;
  for (const path& part : group.relative_path()) {
    if (part == "..") break;  // it is out of sight
    below /= part;
    if (const std::optional<std::uint64_t> here = number_in(below / name))
      least = std::min(least.value_or(*here), *here);
  }
  return least;
}

bool has_memory(const std::string& controllers) {
  std::istringstream list(controllers);
  for (std::string name; std::getline(list, name, ',');)
    if (name == "memory") return true;
  return false;
}

}  // namespace

std::optional<std::uint64_t> cgroup_memory_limit(const std::string& groups, const path& root) {
  std::optional<std::uint64_t> least;
  std::istringstream lines(groups);
  // Each line is NUMBER:CONTROLLERS:PATH; version 2 has no controllers there.
  for (std::string number, controllers, group; std::getline(lines, number, ':') &&
                                               std::getline(lines, controllers, ':') &&
                                               std::getline(lines, group);) {
    std::optional<std::uint64_t> here;
    if (controllers.empty())
      here = least_up(root, group, "memory.max");
    else if (has_memory(controllers))
      here = least_up(root / "memory", group, "memory.limit_in_bytes");
    if (here) least = std::min(least.value_or(*here), *here);
  }
  return least;
}

std::uint64_t available_memory() {
  const std::uint64_t machine =
      static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::ifstream file("/proc/self/cgroup");
  const std::string groups{std::istreambuf_iterator<char>(file), {}};
  // Version 1 says "no limit" by a number larger than any machine's memory.
  return std::min(machine, cgroup_memory_limit(groups, "/sys/fs/cgroup").value_or(machine));
}

std::optional<std::uint64_t> memory_size(const std::string& text) {
  char* end = nullptr;
  if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit(end);
  if (unit.size() == 3 && unit.ends_with("iB")) unit.resize(1);
  constexpr const char* units[] = {"", "K", "M", "G", "T"};
  for (int power = 0; power < 5; ++power) {
    const double bytes = number * std::pow(1024.0, power);
    if (unit == units[power] && bytes < 1e18) return static_cast<std::uint64_t>(bytes);
  }
  return std::nullopt;
}

}  // namespace clothlab
