// Whether the device of the calling thread's current context does it right: what `clothlab selftest` checks.
#pragma once

#include <filesystem>

#include "server/selftest/report.h"

namespace clothlab::selftest {

struct Options {
  bool quick = false;  ///< fewer programs and scenes: under 30 s on two cores of software OpenGL
};

/// Makes all checks and adds them to `report`, in the order in which what is needed comes first.
void run(Report& report, const Options& options);

/// Writes the files of server/selftest/places/ anew to `folder`, from what this device does: to be done where
/// it is known to be right. Error: a scene cannot be stepped, or a file not written.
Status write_places(const std::filesystem::path& folder);

}  // namespace clothlab::selftest
