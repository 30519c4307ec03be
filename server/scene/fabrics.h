// Named fabrics: the numbers of measured cloth, from server/scene/fabrics.json, which says where each is
// from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

struct Fabric {
  std::string name;         ///< one word, as in "fabric": "cotton"
  std::string feel;         ///< what it is like, in one line
  std::string source;       ///< where its numbers are from
  double area_density = 0;  ///< [kg/m^2]
  Fem sheet;                ///< with no grain, and no limit on strain
  /// How far the threads can be stretched before they lock, as shares of their length. None: not known.
  struct Locks {
    double warp = 0, weft = 0;
  };
  std::optional<Locks> locks;
};

/// All fabrics, in the order of the file. An error if the file is absent or wrong.
const Result<std::vector<Fabric>>& fabrics();

}  // namespace clothlab::scene
