// The parts of a scene that can be left out or made coarser, each as a change of the document.
#pragma once

#include <string>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

struct Part {
  std::string name;  ///< of the scene without it: "without bend springs", "half the mesh resolution"
  int coarser = 1;   ///< by this factor; 1: it is no change of the mesh
  /// The document without it. Error: why there is nothing to leave out; `where` may be empty.
  Result<scene::Document> (*without)(const scene::Document&);
};

inline constexpr const char* without_damping = "without damping";

/// In the order in which they are listed to a user.
const std::vector<Part>& parts();

/// The merge patch (RFC 7396) that makes one document of another.
scene::json merge_patch(const scene::json& from, const scene::json& to);

}  // namespace clothlab::lab
