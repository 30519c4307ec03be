// The elements of a model as the kernels gather them: for each law a list of (element, corner) at each
// vertex, in slices of group_size vertices, each padded to its longest list. Sliced ELLPACK, Monakov et al.
// 2010; see shaders/elements/lists.glsl.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/gl/program.h"
#include "server/model/model.h"

namespace clothlab::sim {

struct Plan;

/// One texel of an entry: four 32-bit words.
using Words = std::array<std::uint32_t, 4>;

struct ElementLists {
  std::vector<Words> entries;  ///< rows of group_size texels; an entry takes as many rows as it has texels
  std::vector<std::uint32_t> slices;  ///< for each law [slices + 1]: first row of each slice, then the end
};

ElementLists element_lists(const model::Model& model);

/// Defines LAWS for `#each Law`: all laws or, with a plan, only those of which the plan's scene has elements.
/// Also defines for every law the number of its list: Spring_LIST, ...
gl::Defines law_defines();
gl::Defines law_defines(const Plan& plan);

}  // namespace clothlab::sim
