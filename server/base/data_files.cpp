#include "server/base/data_files.h"

#include <cstdlib>
#include <utility>
#include <vector>

namespace clothlab {

namespace fs = std::filesystem;

namespace {

/// The data that belongs to this program; empty if there is none. One that lies higher up is another
/// program's.
fs::path folder_of_program() {
  std::error_code failure;
  fs::path above = fs::read_symlink("/proc/self/exe", failure);
  while (above.has_relative_path()) {
    above = above.parent_path();
    const fs::path data = fs::canonical(above / "share" / "clothlab", failure);
    if (!failure) return data;
  }
  return {};
}

}  // namespace

Result<fs::path> data_path(const std::string& relative) {
  std::vector<fs::path> roots;
  if (const char* root = std::getenv("CLOTHLAB_DATA")) roots.emplace_back(root);
  if (fs::path root = folder_of_program(); !root.empty()) roots.push_back(std::move(root));
  std::error_code failure;
  for (const fs::path& root : roots)
    if (fs::exists(root / relative, failure)) return root / relative;
  const std::string where = roots.empty()
                                ? "share/clothlab, of which there is none in or above the program's folder"
                                : roots.back().string();
  return Error{
      relative, "not found below " + where,
      "install Clothlab whole (cmake --install), or set CLOTHLAB_DATA to the folder that holds its shaders/ "
      "and web/"};
}

}  // namespace clothlab
