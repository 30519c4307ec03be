#include "server/base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace clothlab {

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const auto refused = [&](const char* why) {
    return Error{path.string(), why, "check that the file exists and is readable"};
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return refused(std::strerror(errno));
  struct stat facts {};
  const bool known = fstat(file, &facts) == 0 && S_ISREG(facts.st_mode);
  const auto size = known ? static_cast<std::size_t>(facts.st_size) : 0;
  void* const start = size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0) : nullptr;
  const int failure = errno;
  close(file);
  if (!known) return refused("it is no file");
  if (start == MAP_FAILED) return refused(std::strerror(failure));
  return MappedFile(start, size);
}

MappedFile::~MappedFile() {
  if (start_) munmap(start_, size_);
}

}  // namespace clothlab
