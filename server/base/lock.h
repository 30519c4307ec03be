// A lock on a folder or a file. The operating system keeps it (flock(2)) and releases it when the process
// ends, however it ends.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

class Lock {
 public:
  enum class Kind {
    exclusive,  ///< one process alone
    shared,     ///< several processes, but none that wants it exclusively
  };
  // On a file system without locks an exclusive lock always succeeds, a shared one never.

  /// Locks a folder, in which this leaves no file. Error: another process holds the lock, or the folder
  /// cannot be opened.
  static Result<Lock> folder(const std::filesystem::path& folder, Kind kind = Kind::exclusive);
  /// Locks a file for this process alone, and makes it if it is missing. Error: as above.
  static Result<Lock> file(const std::filesystem::path& file);
  /// True if another process has locked the file; false if it is missing.
  static bool held_by_another(const std::filesystem::path& file);

  /// Replaces what is in the file that is locked, for others to read. A failure is ignored.
  void write(const std::string& text);

  Lock() = default;
  Lock(Lock&& other) noexcept;
  Lock& operator=(Lock&& other) noexcept;
  ~Lock();

 private:
  static Result<Lock> take(const std::filesystem::path& path, int flags, Kind kind);
  explicit Lock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace clothlab
