// `clothlab validate --fit`: files of meshes as a scene that runs. What their bytes cannot say is chosen, and
// told: the unit, a fabric, contact and a solver that hold.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::cli {

struct FitRequest {
  std::string out;                  ///< the scene's file; the meshes lie in its folder or below
  std::vector<std::string> cloths;  ///< files, one or more
  std::vector<std::string> bodies;  ///< files
  std::string fabric = "cotton";
};

/// Writes the scene into `out`, if it is valid, and returns what was chosen, a sentence each. An existing
/// file is replaced.
Result<std::vector<std::string>> fit_files(const FitRequest& request);

}  // namespace clothlab::cli
