// Reads and writes whole files.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// Returns all bytes of a file.
Result<std::string> read_file(const std::filesystem::path& path);

/// Ending of the name of a file that is still being written.
inline constexpr const char* unfinished_suffix = ".unfinished";

/// Replaces the content of the file at `path` by `bytes`, completely or not at all: a program that reads the
/// file meanwhile, or after this program was killed, finds either the old content or `bytes`. Error: the disk
/// is full, the folder is not writable, ...
Status replace_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace clothlab
