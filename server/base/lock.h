// A lock on a folder that one process at a time can hold. The operating system keeps the lock (flock(2)) and
// releases it when the process ends, however it ends; the lock leaves no file in the folder.
#pragma once

#include <filesystem>

#include "server/base/result.h"

namespace clothlab {

class FolderLock {
 public:
  /// Locks `folder`. Error: another process holds the lock, or the folder cannot be opened. On a file system
  /// without locks every call succeeds.
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
