#include "server/base/cache_folder.h"

#include <cstdlib>

namespace clothlab {

namespace fs = std::filesystem;

fs::path cache_folder(const std::string& part) {
  // A relative path would depend on the current folder; the XDG specification says to ignore it.
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache && fs::path(cache).is_absolute()) return fs::path(cache) / "clothlab" / part;
  const char* home = std::getenv("HOME");
  if (home && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "clothlab" / part;
  return {};
}

}  // namespace clothlab
