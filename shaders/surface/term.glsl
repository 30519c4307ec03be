// Contact as a term of the step's problem: the energies of pairs (elements/surface_energy.glsl) that a method minimises
// with inertia's and the elements'. For each iterate (server/sim/contact_term.h) the pairs that press are found, and
// listed at their vertices; and for each change of it the share that it may be taken of, so that nothing meets, and the
// energy at shares of that.
#include "surface.glsl"
#include "../elements/surface_energy.glsl"

/// A list on the GPU: xyz the groups of a dispatch over it, w its length.
struct Term {
  uvec4 kept;       // listed pairs that may press
  uvec4 pressing;   // pairs that press
  uvec4 touched;    // vertices that they touch
  uvec4 reachable;  // listed pairs that may press on the way
  uint entries;     // of the vertices' lists
  uint share;       // of the way that may be taken, as bits
  uint longest;     // the longest way of a free vertex [m], as bits
  uint pressed;     // the same of one that a pair presses
  uint taken;       // the share of the way that is taken, the same
  uint pins;        // of that, the share that pins go: they wait before bodies, the same
  uint meets;       // vertices that solids may press on the way
  uint unused;
  uvec4 largest;    // at each share tried, the largest change of a pair's energy [J], as bits
  ivec4 high;       // at each share tried, the sum of these changes, in units of `largest` (in_units): the first ...
  uvec4 low;        // ... and the second part
  uvec4 rubs;       // xy: the sum of the friction of all pairs that press, in such units; zw: of what it is off by
                    // after the way from what it was taken to be
};
layout(std430, binding = slot_term_control) coherent buffer TermControl { Term term; };

#define APPEND(list, place)                            \
  uint place = atomicAdd(term.list.w, 1u);             \
  if (place % uint(GROUP_SIZE) == 0u) atomicMax(term.list.x, place / uint(GROUP_SIZE) + 1u);

/// A part of a whole in 2^20 units, for a sum over all pairs that depends on no order of threads: how many times 2048,
/// and the rest. Of the 2^21 pairs that there may be (server/sim/contact_term.cpp), the sum of neither overflows.
ivec2 in_units(float part) {
  int units = int(round(clamp(part, -1.0, 1.0) * 1048576.0));
  return ivec2(units >> 11, units & 2047);
}

/// Texels of a pair that presses: corners (surface.glsl); n and the stiffness along it [N/m]; weights; the force on the
/// first part [N] and the stiffness of friction across n [N/m]; what it has slid in the step, in the first iterate what
/// it is expected to slide [m], and the friction that slides [N]; the relative velocity that bodies have yet to bring
/// [m/s], and by how much less the stiffness of friction is in the direction slid [N/m].
const uint pair_texels = 6u;

