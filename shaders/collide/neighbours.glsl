// For each vertex, the list of vertices that it may touch within the next few steps. A spatial hash with a skin builds
// the lists, as in molecular dynamics (Verlet 1967); they hold until a vertex has moved half the skin. Each list is
// sorted by distance, then index, so that sums over it do not depend on the order in which threads ran.
#include "../slots.glsl"
#ifndef NEIGHBOUR_SLOTS
#define NEIGHBOUR_SLOTS 64
#endif

// Set by the GPU: arguments of the indirect dispatches of a rebuild, and counts of what rebuilds did.
layout(std430, binding = slot_neighbour_control) buffer NeighbourControl {
  uint rebuild_groups, rebuild_groups_y, rebuild_groups_z;  // fills the hash: 0 or all work groups
  uint rebuilds;  // how often the lists were built
  uint dropped;   // neighbours that found no slot, summed over all rebuilds
  uint longest;   // longest list that was needed, over all rebuilds; counted from half of the slots on
  uint search_groups, search_on, search_groups_z;  // one range of the search: its groups, times 0 or 1
  uint finish_groups, finish_groups_y, finish_groups_z;  // last part of the search, asked for by the part before
};
