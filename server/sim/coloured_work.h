// The lists of elements or vertices that the sweeps of PBD, XPBD and VBD visit, colour after colour, as
// shaders/methods/gauss_seidel.comp reads them; and the choice between the two forms of that kernel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/gl/program.h"
#include "server/model/colouring.h"
#include "server/sim/element_lists.h"

namespace clothlab::sim {

/// What a sweep visits, colour after colour: each law's elements (PBD, XPBD), or the vertices (VBD). The
/// colours of one function follow each other; items are numbered over all of them.
struct Visits : model::Colouring {
  struct Function {
    std::string name;  ///< in shaders/methods/: visit_vertex, or visit_Spring and so on for each law
    std::uint32_t first_colour = 0, end_colour = 0;
  };
  std::vector<Function> functions;
};

/// The elements of each law with at least one free corner: functions[k] visits law number k. The items are
/// indices into the law's batch.
Visits visited_elements(const model::Model& model, const scene::Scene& scene);
/// The vertices that are not pinned. The items are indices of vertices.
Visits visited_vertices(const model::Model& model, const scene::Scene& scene);

/// The vertices, rest values and gains of visited elements, as shaders/methods/element_projection.glsl reads
/// them.
std::vector<Words> visit_list(const Visits& visits, const model::Model& model, const scene::Scene& scene);
/// Number of pushes that XPBD remembers of the visited elements: one for each corner but the first.
std::size_t remembered_pushes(const Visits& visits);
/// Defines EACH_VISIT, and for each law where its visits, items and pushes begin: Spring_FIRST_TEXEL, ...
gl::Defines visit_defines(const Visits& visits, bool elements);

/// Number of threads in the one work group that does a whole step; 0 if a step must take many dispatches
/// instead, because a work group has too little shared memory or a thread would have too many turns of loops.
/// A GPU gets as many threads as a work group can have. Software OpenGL runs 8 at a time, and each barrier
/// costs more with more threads; but it silently ends every loop of a kernel after 65535 turns in all
/// (gallivm's LP_MAX_TGSI_LOOP_ITERATIONS). So it gets the fewest threads, 8 to 128, with which
/// `turns(threads)`, the turns in one thread, stay well below that. And it reads shared memory thread by
/// thread: where it computes on the thread that calls, many dispatches are faster for more than `small`
/// vertices. CLOTHLAB_SWEEPS=dispatches or one_group in the environment forces a form, to compare the two.
std::uint32_t lanes_of_one_group(std::uint32_t vertex_count, bool self_collision, std::uint32_t small,
                                 const std::function<std::uint64_t(std::uint32_t)>& turns);

}  // namespace clothlab::sim
