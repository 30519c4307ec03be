// What the sweeps of PBD, XPBD and VBD visit, colour after colour, as shaders/methods/gauss_seidel.comp reads
// it; and in which of its two forms the kernel runs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/model/colouring.h"

namespace clothlab::sim {

/// The springs that have a free end: indices into model.springs.
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

/// Turns of all loops of a sweep, contacts included, that one work group of the lanes below takes: over the
/// items of each colour, and within an item over `inner` more.
std::uint64_t turns_of_sweep(const model::Colouring& work, std::uint32_t inner);

/// True where one work group is faster than many dispatches, and its shared memory is enough. Software OpenGL
/// ends every loop of a kernel after 65535 turns in all (gallivm's LP_MAX_TGSI_LOOP_ITERATIONS), silently: a
/// step that needs more `turns` is not for one kernel there. CLOTHLAB_SWEEPS=one_group or =dispatches in the
/// environment decides otherwise, to compare the two.
bool fits_one_group(std::uint32_t vertex_count, bool self_collision, std::uint64_t turns);
/// Threads of that work group. Software OpenGL runs 8 at a time and pays for more at every barrier; a GPU
/// wants all it can have.
int lanes_of_one_group();

}  // namespace clothlab::sim
