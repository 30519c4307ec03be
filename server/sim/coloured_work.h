// The lists of elements or vertices that the sweeps of PBD, XPBD and VBD visit, colour after colour, as
// shaders/methods/gauss_seidel.comp reads them.
#pragma once

#include <cstddef>
#include <cstdint>
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
    bool visits() const { return end_colour > first_colour; }  ///< any item
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
/// Defines EACH_VISIT and VISIT_ROOM, the length of an array of its visits, and for elements the laws and how
/// long their visits are: Spring_VISIT_TEXELS, ... No number depends on how many items there are: cloths of
/// all sizes share a kernel.
gl::Defines visit_defines(const Visits& visits, bool elements);
/// Tells a kernel that has these defines where each law's items, visits and pushes begin, and the colours of
/// each function.
void set_visits(const gl::Program& program, const Visits& visits, bool elements);

}  // namespace clothlab::sim
