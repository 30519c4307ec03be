// What the sweeps of PBD, XPBD and VBD visit, colour after colour, as shaders/methods/gauss_seidel.comp reads
// it; and in which of its two forms the kernel runs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/model/colouring.h"

namespace clothlab::sim {

/// The springs that have a free end: indices into model.springs().
model::Colouring visited_springs(const model::Model& model, const scene::Scene& scene);
/// The free vertices.
model::Colouring visited_vertices(const model::Model& model, const scene::Scene& scene);

struct ProjectedSprings {
  struct Entry {
    std::uint32_t a = 0, b = 0;
    float rest_length = 0, stretch_gain = 0;
  };
  std::vector<Entry> entries;               ///< in the order of `visited`
  std::vector<std::array<float, 2>> gains;  ///< damping, memory
};
ProjectedSprings projected_springs(const model::Colouring& visited, const model::Model& model,
                                   const scene::Scene& scene);

/// Threads of the one work group that does a whole step; 0 where many dispatches are faster, or where its
/// shared memory is too little. A GPU wants all it can have. Software OpenGL runs 8 at a time and pays for
/// more at every barrier; but it ends every loop of a kernel after 65535 turns in all (gallivm's
/// LP_MAX_TGSI_LOOP_ITERATIONS), silently: it gets as many as keep `turns(lanes)` below that.
/// CLOTHLAB_SWEEPS=dispatches in the environment decides for those, to compare the two.
std::uint32_t lanes_of_one_group(std::uint32_t vertex_count, bool self_collision,
                                 const std::function<std::uint64_t(std::uint32_t)>& turns);

}  // namespace clothlab::sim
