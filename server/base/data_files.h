// Where the files that travel with the program are: shaders/, server/scene/presets/, web/dist/.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// Finds `relative` (e.g. "shaders/methods/symplectic_euler.comp") below, in this order: $CLOTHLAB_DATA,
/// <program>/../share/clothlab, the source tree this program was built from.
Result<std::filesystem::path> data_path(const std::string& relative);

}  // namespace clothlab
