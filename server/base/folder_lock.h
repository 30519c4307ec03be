// A folder that one process at a time may call its own. The claim is the kernel's and ends with the process,
// however that ends; nothing of it lies in the folder.
#pragma once

#include <filesystem>

#include "server/base/result.h"

namespace clothlab {

class FolderLock {
 public:
  /// Error: another process holds it, or it cannot be opened. Where the file system knows no locks, it is
  /// held by whoever asks.
  static Result<FolderLock> take(const std::filesystem::path& folder);
  FolderLock() = default;
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  ~FolderLock();

 private:
  explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace clothlab
