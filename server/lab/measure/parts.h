// The parts of a scene that can be left out or made coarser, each as a change of the scene document.
#pragma once

#include <string>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

struct Part {
  std::string name;  ///< of the changed scene: "without bend springs", "half the mesh resolution"
  int coarser = 1;   ///< the mesh resolution is divided by this factor; 1: the mesh stays as it is
  /// Returns the document without the part. Error: why there is nothing to leave out; its `where` may be
  /// empty.
  Result<scene::Document> (*without)(const scene::Document&);
};

inline constexpr const char* without_damping = "without damping";

/// All parts, in the order in which they are listed to a user.
const std::vector<Part>& parts();

/// The merge patch (RFC 7396) that turns `from` into `to`.
scene::json merge_patch(const scene::json& from, const scene::json& to);

}  // namespace clothlab::lab
