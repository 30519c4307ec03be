// The fuzz targets by their names, where they are one program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace clothlab::fuzz {

/// A target's LLVMFuzzerTestOneInput.
using Target = int (*)(const std::uint8_t* data, std::size_t size);

/// Defined in a source that CMakeLists.txt generates.
extern const std::map<std::string, Target> targets;

}  // namespace clothlab::fuzz
