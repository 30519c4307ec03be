// Neighbour search, 3 of 3. A vertex that found no room in another's full list drops that one from its own, too: a
// contact known to one of two vertices would create momentum. Then the hash is emptied for the next search.
layout(local_size_x = GROUP_SIZE) in;
#include "neighbours.glsl"

uniform int vertex_count;
layout(std430, binding = slot_cell_heads) writeonly buffer CellHeads { uint head[]; };  // [CELL_COUNT]
layout(std430, binding = slot_neighbour_count) readonly buffer NeighbourCounts { uint neighbour_count[]; };
layout(std430, binding = slot_neighbours) coherent buffer Neighbours { uvec2 neighbours[]; };

/// True if i is in j's list. Other work groups may remove vertices from j's list meanwhile, but not i, since j is in
/// i's list.
bool lists(uint j, uint i) {
  for (int slot = 0; slot < NEIGHBOUR_SLOTS; ++slot)
    if (neighbours[int(j) * NEIGHBOUR_SLOTS + slot].x == i) return true;
  return false;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) finish_groups = 0;
  for (uint cell = gl_GlobalInvocationID.x; cell < CELL_COUNT; cell += gl_NumWorkGroups.x * GROUP_SIZE)
    head[cell] = 0xffffffffu;
  if (i >= vertex_count) return;
  int first = i * NEIGHBOUR_SLOTS, count = int(neighbour_count[i]);
  for (int slot = 0; slot < count; ++slot) {
    uint j = neighbours[first + slot].x;
    // An entry that names its own vertex is ignored: a vertex never touches itself.
    if (neighbour_count[j] == NEIGHBOUR_SLOTS && !lists(j, uint(i))) neighbours[first + slot].x = uint(i);
  }
}
