// Finds the files that are installed with the program: shaders/, server/scene/presets/,
// server/scene/fabrics.json, server/selftest/scenes/ and places/, web/dist/, web/pictures/, web/clients/.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// The path of the file or folder `relative` (e.g. "shaders/methods/symplectic_euler.comp") in the first of
/// these folders that has it: $CLOTHLAB_DATA, <the program's folder>/../share/clothlab, the source tree from
/// which this program was built.
Result<std::filesystem::path> data_path(const std::string& relative);

}  // namespace clothlab
