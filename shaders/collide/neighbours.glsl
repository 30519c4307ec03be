// The lists of vertices that may touch within the next few steps: built by a spatial hash with a skin, as in molecular
// dynamics (Verlet 1967), and good until a vertex has moved half the skin. Each list is sorted by distance, then index,
// so that sums over it do not depend on the order in which threads ran.
#include "../slots.glsl"
#ifndef NEIGHBOUR_SLOTS
#define NEIGHBOUR_SLOTS 64
#endif

// What the GPU decides for itself: arguments of the indirect dispatches of a rebuild, and what became of it.
layout(std430, binding = slot_neighbour_control) buffer NeighbourControl {
  uint rebuild_groups, rebuild_groups_y, rebuild_groups_z;  // of what fills the hash: 0 or all work groups
  uint rebuilds;  // how often the lists were built
  uint dropped;   // neighbours that found no slot, over all rebuilds
  uint longest;   // list there would have been, over all rebuilds; told from half of the slots on
  uint search_groups, search_on, search_groups_z;  // of the search, a range at a time: that many, times 0 or 1
  uint finish_groups, finish_groups_y, finish_groups_z;  // of the search's last part, which the one before asks for
};
