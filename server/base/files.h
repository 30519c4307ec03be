// Reads and writes whole files.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "server/base/result.h"

namespace clothlab {

/// Returns all bytes of a file.
Result<std::string> read_file(const std::filesystem::path& path);

/// True if there is anything at `path`: a file, a folder, a pipe, a link to nothing, ...
bool is_taken(const std::filesystem::path& path);
/// `path`, or, if something is there, the first of PATH-2, PATH-3, ... where nothing is.
std::filesystem::path free_path(std::filesystem::path path);

/// What is in the way of a new file.
struct InTheWay {
  Error why;           ///< with where it is now, and what to do
  bool moved = false;  ///< false: it is where it was, and nothing may be written there
};
/// Renames a file that cannot be used because of `what` to FILE.unreadable, with a number behind it if there
/// is one.
InTheWay move_aside(const std::filesystem::path& file, const std::string& what);
/// What to do about something that could not be moved.
std::string not_moved(const std::filesystem::path& aside, const std::error_code& failure);

/// Ending of the name of a file that is still being written.
inline constexpr const char* unfinished_suffix = ".unfinished";

/// Replaces the content of the file at `path` by `bytes`, completely or not at all: a program that reads the
/// file meanwhile, or after this program was killed, finds either the old content or `bytes`. Error: the disk
/// is full, the folder is not writable, ...
Status replace_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace clothlab
