#include "server/base/lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace clothlab {

Result<Lock> Lock::take(const std::filesystem::path& path, int flags, Kind kind) {
  constexpr mode_t of_owner = 0600;
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC, of_owner);
  if (descriptor < 0)
    return Error{path.string(), std::string("cannot be opened: ") + std::strerror(errno),
                 "give a folder that can be read and written"};
  Lock lock(descriptor);
  if (flock(descriptor, (kind == Kind::shared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0) return lock;
  if (errno == EWOULDBLOCK)
    return Error{path.string(),
                 std::string("another process is using this ") + (flags & O_DIRECTORY ? "folder" : "file"),
                 "end that process, or choose a different folder"};
  if (kind == Kind::shared)
    return Error{path.string(), std::string("its file system has no locks: ") + std::strerror(errno),
                 "choose a folder on a file system that locks between machines, such as NFS 4"};
  return lock;
}

Result<Lock> Lock::folder(const std::filesystem::path& folder, Kind kind) {
  return take(folder, O_RDONLY | O_DIRECTORY, kind);
}

Result<Lock> Lock::file(const std::filesystem::path& file) {
  return take(file, O_RDWR | O_CREAT, Kind::exclusive);
}

bool Lock::held_by_another(const std::filesystem::path& file) {
  std::error_code failure;
  return std::filesystem::exists(file, failure) && !Lock::file(file);
}

void Lock::write(const std::string& text) {
  if (descriptor_ < 0 || ftruncate(descriptor_, 0) != 0) return;
  (void)!pwrite(descriptor_, text.data(), text.size(), 0);
}

Lock::Lock(Lock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

Lock& Lock::operator=(Lock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

Lock::~Lock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace clothlab
