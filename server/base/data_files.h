// Finds the files that are installed with the program: shaders/, server/scene/presets/,
// server/scene/fabrics.json, server/selftest/scenes/ and places/, web/dist/, web/pictures/, web/clients/.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace clothlab {

/// The path of the file or folder `relative` (e.g. "shaders/methods/symplectic_euler.comp") in
/// $CLOTHLAB_DATA, or else in share/clothlab in the program's folder or the nearest folder above it that has
/// one: /usr/share/clothlab for /usr/bin/clothlab, wherever it was moved to. A build tree's share/clothlab is
/// a link to the sources.
Result<std::filesystem::path> data_path(const std::string& relative);

}  // namespace clothlab
