// Colours for methods that move vertices one after another (PBD, XPBD, VBD): what has one colour has no
// vertex in common, or no spring between, and so can be done at once without a race, in any order, with one
// outcome.
#pragma once

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

/// Springs of one colour share no vertex. Grids: the 12 colours of their 12 neighbours in closed form, fewer
/// where kinds of springs are missing. Other meshes: greedily, least crowded colour first. Deterministic.
Colouring colour_springs(const Model& model, const scene::Scene& scene);

/// Vertices of one colour have no spring between them. Grids: 5 colours, (column + 2 row) mod 5. Other
/// meshes: greedily, the vertices with most springs first (Welsh & Powell 1967), least crowded colour first.
/// Deterministic.
Colouring colour_vertices(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
