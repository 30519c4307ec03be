// Neighbour search, 3 of 3: what has no room in one vertex's full list leaves the other's too, since of a contact that
// only one of the two knew momentum would come out of nothing; and the hash is emptied for the next search.
layout(local_size_x = GROUP_SIZE) in;
#include "neighbours.glsl"

uniform int vertex_count;
layout(std430, binding = slot_cell_heads) writeonly buffer CellHeads { uint head[]; };  // [CELL_COUNT]
layout(std430, binding = slot_neighbour_count) readonly buffer NeighbourCounts { uint neighbour_count[]; };
layout(std430, binding = slot_neighbours) coherent buffer Neighbours { uvec2 neighbours[]; };

/// Other work groups may be leaving vertices out of j's list meanwhile, but not i, since j is in i's.
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
    // A vertex never touches itself.
    if (neighbour_count[j] == NEIGHBOUR_SLOTS && !lists(j, uint(i))) neighbours[first + slot].x = uint(i);
  }
}
