#include "server/base/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "server/base/text.h"

namespace clothlab {

namespace fs = std::filesystem;

Result<std::string> read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{path.string(), "cannot be read", "check that the file exists and is readable"};
  return std::string(std::istreambuf_iterator<char>(file), {});
}

bool is_taken(const fs::path& path) {
  std::error_code failure;  // what cannot be asked about is there
  return fs::symlink_status(path, failure).type() != fs::file_type::not_found;
}

fs::path free_path(fs::path path) {
  const std::string first = path.string();
  std::error_code failure;  // in a folder that cannot be read every path is as good
  for (int number = 2; fs::exists(fs::symlink_status(path, failure)); ++number)
    path = first + "-" + std::to_string(number);
  return path;
}

InTheWay move_aside(const fs::path& file, const std::string& what) {
  fs::path aside = file;
  aside = free_path(aside += ".unreadable");
  std::error_code failure;
  fs::rename(file, aside, failure);
  if (failure) return {{file.string(), what, not_moved(aside, failure)}};
  return {{file.string(), what, "it was moved to " + aside.string()}, true};
}

std::string not_moved(const fs::path& aside, const std::error_code& failure) {
  return "it could not be moved to " + aside.string() + " (" + failure.message() + "): move it away";
}

Status replace_file(const fs::path& path, const std::string& bytes) {
  fs::path unfinished = path;
  // Not the process alone: in two containers it may have one number, and in both this thread, too.
  unfinished += formatted(".%d-%08x%s", getpid(), std::random_device{}(), unfinished_suffix);
  std::error_code failure;
  errno = 0;
  {
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) failure.assign(errno == 0 ? EIO : errno, std::generic_category());
  }
  if (!failure) fs::rename(unfinished, path, failure);
  if (!failure) return ok();
  std::error_code ignored;
  fs::remove(unfinished, ignored);
  return Error{path.string(), "could not be written: " + failure.message(),
               "check the disk's space and the folder's permissions"};
}

}  // namespace clothlab
