// The lists of springs or vertices that the sweeps of PBD, XPBD and VBD visit, colour after colour, as
// shaders/methods/gauss_seidel.comp reads them; and the choice between the two forms of that kernel.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/model/colouring.h"

namespace clothlab::sim {

/// Colours of the springs with at least one free end. The items are indices into model.springs().
model::Colouring visited_springs(const model::Model& model, const scene::Scene& scene);
/// Colours of the vertices that are not pinned. The items are indices of vertices.
model::Colouring visited_vertices(const model::Model& model, const scene::Scene& scene);

/// Constants of the springs for PBD and XPBD: `projected` and `gains` in spring_projection.glsl.
struct ProjectedSprings {
  struct Entry {
    std::uint32_t a = 0, b = 0;
    float rest_length = 0, stretch_gain = 0;
  };
  std::vector<Entry> entries;               ///< in the order of `visited`
  std::vector<std::array<float, 2>> gains;  ///< in the same order: damping gain [kg], memory
};
ProjectedSprings projected_springs(const model::Colouring& visited, const model::Model& model,
                                   const scene::Scene& scene);

/// Number of threads in the one work group that does a whole step; 0 if a step must take many dispatches
/// instead, because a work group has too little shared memory or a thread would have too many turns of loops.
/// A GPU gets as many threads as a work group can have. Software OpenGL runs 8 at a time, and each barrier
/// costs more with more threads; but it silently ends every loop of a kernel after 65535 turns in all
/// (gallivm's LP_MAX_TGSI_LOOP_ITERATIONS). So it gets the fewest threads, 8 to 128, with which
/// `turns(threads)`, the turns in one thread, stay well below that. CLOTHLAB_SWEEPS=dispatches in the
/// environment makes it 0, to compare the two forms.
std::uint32_t lanes_of_one_group(std::uint32_t vertex_count, bool self_collision,
                                 const std::function<std::uint64_t(std::uint32_t)>& turns);

}  // namespace clothlab::sim
