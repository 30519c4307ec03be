// How much memory this process may take, as the system says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace clothlab {

/// The least limit of the control groups that a process is in, version 2 or 1, its own and all above [bytes];
/// none: no group has a limit. `groups` is the text of /proc/PID/cgroup, `root` where the groups' files are.
/// In a container the group of that text may be out of sight: then the root is its own.
std::optional<std::uint64_t> cgroup_memory_limit(const std::string& groups,
                                                 const std::filesystem::path& root);

/// The smaller of this process's control groups' limit and the machine's memory [bytes].
std::uint64_t available_memory();

/// "2G", "1.5GiB", "512M" or a number of bytes; K, M and G are powers of 1024. None: it is no such text.
std::optional<std::uint64_t> memory_size(const std::string& text);

}  // namespace clothlab
