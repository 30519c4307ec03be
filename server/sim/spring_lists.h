// The springs of a model as the kernels read them: slices of group_size vertices, each padded to its longest
// list. Sliced ELLPACK, Monakov et al. 2010; see shaders/collide/spring_lists.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace clothlab::sim {

struct SpringEntry {
  std::uint32_t other = 0;  ///< the vertex at the other end; padding names the vertex itself
  float rest_length = 0;    ///< [m]
  float stiffness = 0;      ///< [N/m]
  float damping = 0;        ///< [N s/m]
};

struct SpringLists {
  std::vector<SpringEntry> entries;
  std::vector<std::uint32_t> slices;  ///< [slices + 1] first slot of each slice
};

SpringLists spring_lists(const model::Model& model, const scene::Scene& scene);

}  // namespace clothlab::sim
