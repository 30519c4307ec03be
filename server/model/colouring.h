// Colours for methods that move vertices one after another (PBD, XPBD, VBD). Elements of one colour share no
// vertex, and vertices of one colour share no element: all can be treated at once without a race, and the
// order does not change the result.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// The items of colour c are order[offsets[c]] ... order[offsets[c + 1] - 1], in rising order.
struct Colouring {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> offsets;  ///< [colours + 1]
  std::uint32_t colours() const { return static_cast<std::uint32_t>(offsets.size()) - 1; }
};

/// Colours each law's elements so that those of one colour share no vertex. A grid's springs get 12 colours
/// in closed form, two for each of six pairs of direction and length, and fewer where kinds of springs are
/// missing. All other elements are coloured greedily: each gets the colour with fewest members.
/// Deterministic.
std::array<Colouring, elements::swept_count> colour_elements(const Model& model, const scene::Scene& scene);

/// Colours vertices so that those of one colour share no element. A grid gets 5 colours, (column + 2 row) mod
/// 5, if its elements allow it, as springs do. Other meshes are coloured greedily: vertices with most
/// elements first (Welsh & Powell 1967), each with the colour that has fewest members. Deterministic.
Colouring colour_vertices(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
