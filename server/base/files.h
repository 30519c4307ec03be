// Reads and writes whole files.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// Returns all bytes of a file.
Result<std::string> read_file(const std::filesystem::path& path);

/// True if there is anything at `path`: a file, a folder, a pipe, a link to nothing, ...
bool is_taken(const std::filesystem::path& path);
/// `path`, or, if something is there, the first of PATH-2, PATH-3, ... where nothing is.
std::filesystem::path free_path(std::filesystem::path path);

/// Ending of the name of a file that is still being written.
inline constexpr const char* unfinished_suffix = ".unfinished";

/// Replaces the content of the file at `path` by `bytes`, completely or not at all: a program that reads the
/// file meanwhile, or after this program was killed, finds either the old content or `bytes`. Error: the disk
/// is full, the folder is not writable, ...
Status replace_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace clothlab
