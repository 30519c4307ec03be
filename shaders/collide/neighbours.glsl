// The lists of vertices that may touch within the next few steps: built by a spatial hash with a skin, as in molecular
// dynamics (Verlet 1967), and good until a vertex has moved half the skin. Each list is sorted by distance, then index,
// so that sums over it do not depend on the order in which threads ran.
#define NEIGHBOUR_SLOTS 64

// What the GPU decides for itself: arguments of the indirect dispatches of a rebuild, and what became of it.
layout(std430, binding = 2) buffer NeighbourControl {
  uint rebuild_groups, rebuild_groups_y, rebuild_groups_z;  // of what empties and fills the hash: 0 or all work groups
  uint rebuilds;  // how often the lists were built
  uint dropped;   // neighbours that found no slot, over all rebuilds
  uint search_groups, search_on, search_groups_z;  // of the search, a range of vertices at a time: that many, times 0 or 1
};
