// Where results are kept that may be measured again at any time.
#pragma once

#include <filesystem>
#include <string>

namespace clothlab {

/// $XDG_CACHE_HOME/clothlab/PART, or ~/.cache/clothlab/PART; empty where neither $XDG_CACHE_HOME nor $HOME is
/// an absolute path.
std::filesystem::path cache_folder(const std::string& part);

}  // namespace clothlab
