// The choice between the two forms of shaders/methods/gauss_seidel.comp: one work group does a whole step, or
// a dispatch each phase and each colour. Both come to the same state, bit for bit.
#pragma once

#include <cstdint>
#include <functional>

namespace clothlab::sim {

/// What the choice depends on.
struct SweptCloth {
  std::uint32_t vertices = 0;
  std::uint32_t dispatches = 0;  ///< of a sweep, in the form of many
  bool by_vertex = false;        ///< sweeps visit vertices (VBD), not elements
  bool self_collision = false;
  /// Upper bound of the turns that one thread takes in all loops of a step, if the work group has so many.
  std::function<std::uint64_t(std::uint32_t threads)> turns;
};

/// Number of threads in the one work group that does a whole step; 0 if a step must take many dispatches
/// instead: because they are faster on the device of the current context, because a work group has too little
/// shared memory, or because a thread would have too many turns of loops. A GPU gets as many threads as a
/// work group can have, software OpenGL the fewest that will do (gl::fewest_lanes).
/// CLOTHLAB_SWEEPS=dispatches or one_group in the environment decides which form is faster, to compare the
/// two.
std::uint32_t lanes_of_one_group(const SweptCloth& cloth);

/// The number of vertices for which the one work group has shared memory: a power of two, so that few kernels
/// are compiled for all sizes of cloth, or, where that is too much, as many as there is memory for.
std::uint32_t vertex_room(std::uint32_t vertices, bool self_collision);

/// One work group takes longer with each vertex, as many dispatches do with each of them. The two are even at
/// so many vertices for each dispatch of a sweep: measured once on a device (gl/device_fact.h), with sheets
/// of springs of two sizes, under XPBD or, by vertex, VBD.
double vertices_a_dispatch(bool by_vertex);

}  // namespace clothlab::sim
