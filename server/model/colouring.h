// Colours for methods that move vertices one after another (PBD, XPBD, VBD): what has one colour has no
// vertex in common, or no element, and so can be done at once without a race, in any order, with one outcome.
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

/// Elements of one colour share no vertex. A grid's springs: the 12 colours of their 12 directions in closed
/// form, fewer where kinds of springs are missing. All else: greedily, least crowded colour first.
/// Deterministic. Defined for every law.
template <class Law>
Colouring colour_elements(const Model& model, const scene::Scene& scene, const Batch<Law>& batch);

/// Vertices of one colour have no element in common. Grids with springs: 5 colours, (column + 2 row) mod 5.
/// Other meshes: greedily, the vertices with most elements first (Welsh & Powell 1967), least crowded colour
/// first. Deterministic.
Colouring colour_vertices(const Model& model, const scene::Scene& scene);

}  // namespace clothlab::model
