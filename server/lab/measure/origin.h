// What a result of the lab was measured of, and when.
#pragma once

#include <string>

namespace clothlab::lab {

struct Origin {
  std::string scene_hash;  ///< of what the motion depends on in the scene (scene_hash.h); empty: not known
  std::string date;        ///< when the measurement began, UTC (RFC 3339); empty: not known
};

}  // namespace clothlab::lab
