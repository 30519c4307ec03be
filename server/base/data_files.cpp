#include "server/base/data_files.h"

#include <cstdlib>
#include <iterator>
#include <vector>

namespace clothlab {

namespace fs = std::filesystem;

Result<fs::path> data_path(const std::string& relative) {
  std::vector<fs::path> roots;
  if (const char* root = std::getenv("CLOTHLAB_DATA")) roots.emplace_back(root);
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (!failure) roots.push_back(program.parent_path().parent_path() / "share" / "clothlab");
  roots.emplace_back(CLOTHLAB_SOURCE_DIR);
  for (const fs::path& root : roots)
    if (fs::exists(root / relative, failure)) return root / relative;
  return Error{relative, "not found below " + roots.back().string(),
               "set CLOTHLAB_DATA to the folder that holds Clothlab's shaders/ and web/"};
}

}  // namespace clothlab
