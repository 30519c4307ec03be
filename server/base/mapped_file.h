// A file whose bytes are read as if they were in memory: only what is used of it is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>

#include "server/base/result.h"

namespace clothlab {

class MappedFile {
 public:
  /// Error: the file is not there, is a folder, or may not be read.
  static Result<MappedFile> open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept
      : start_(std::exchange(other.start_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  MappedFile& operator=(MappedFile&&) = delete;

  /// The bytes, while this object lives and nobody makes the file shorter.
  std::string_view bytes() const { return {static_cast<const char*>(start_), size_}; }

 private:
  MappedFile(void* start, std::size_t size) : start_(start), size_(size) {}
  void* start_;
  std::size_t size_;
};

}  // namespace clothlab
