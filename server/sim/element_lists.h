// The elements of a model as the kernels gather them: for each law a list of (element, corner) at each
// vertex, in slices of group_size vertices, each padded to its longest list. Sliced ELLPACK, Monakov et al.
// 2010; see shaders/elements/lists.glsl.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/gl/program.h"
#include "server/model/model.h"

namespace clothlab::sim {

/// One texel of an entry: four 32-bit words.
using Words = std::array<std::uint32_t, 4>;

struct ElementLists {
  std::vector<Words> entries;  ///< rows of group_size texels; an entry takes as many rows as it has texels
  std::vector<std::uint32_t> slices;  ///< for each law [slices + 1]: first row of each slice, then the end
};

ElementLists element_lists(const model::Model& model);

/// A number as kernels read it: the bits of its float32.
std::uint32_t word(double number);

/// Writes a word into texels, at the word number `at`, which it increases.
template <std::size_t count>
void put(std::array<Words, count>& texels, std::size_t& at, std::uint32_t written) {
  texels[at / 4][at % 4] = written;
  ++at;
}

/// For each law true if kernels are compiled with it.
using LawSet = std::array<bool, elements::law_count>;

/// Defines LAWS for `#each Law`: the laws of the set. Also defines for every law the numbers that kernels
/// need of it: Spring_LIST, the number of its list, Spring_CORNERS, ...
gl::Defines law_defines(const LawSet& compiled);

}  // namespace clothlab::sim
