// Whole files, read and written.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// The whole of a file as bytes.
Result<std::string> read_file(const std::filesystem::path& path);

/// What is still being written ends so.
inline constexpr const char* unfinished_suffix = ".unfinished";

/// Puts `bytes` where `path` says, whole or not at all: whoever reads meanwhile, or finds it after this
/// program was killed, has what was there before or this. Error: the disk is full, the folder not writable,
/// ...
Status replace_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace clothlab
