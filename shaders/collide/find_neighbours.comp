// Neighbour search, 2 of 3: lists for each vertex the other vertices within reach, the nearest NEIGHBOUR_SLOTS of them.
// Each entry holds the distance that self-collision keeps between the two: min(thickness, rest distance).
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "cells.glsl"
#include "neighbours.glsl"

READ_VEC4(position, unit_position);
READ_UINT(head, unit_cell_heads);
READ_UVEC4(links, unit_cell_chains);  // xyz: the vertex' place, as bits; w: the next one in the cell
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
READ_UINT(excluded, unit_excluded);  // vertices that self-collision leaves out, vertex after vertex
READ_UINT(first_excluded, unit_first_excluded);  // [vertex_count + 1]
uniform float thickness;
uniform int first_vertex;  // first vertex of this dispatch's range
layout(std430, binding = slot_neighbour_count) writeonly buffer NeighbourCounts { uint neighbour_count[]; };
// (vertex, distance): vertex i's slot s at i * SLOTS + s
layout(std430, binding = slot_neighbours) buffer Neighbours { uvec2 neighbours[]; };

float rest_distance(int i, int j) {
  vec4 a = FETCH(rest_position, i), b = FETCH(rest_position, j);
  return a.w == b.w ? distance(a.xyz, b.xyz) : thickness;
}

/// Vertices that self-collision leaves out at one vertex. The first twelve, as many as a grid's vertex has springs, are
/// held in registers: the search asks for each near pair, and memory is slow to ask. The others are entries `next` to
/// `end` - 1 of `excluded`.
struct LeftOut {
  uvec4 held[3];
  int next, end;
};

LeftOut left_out_at(int i) {
  int first = int(FETCH_UINT(first_excluded, i)), end = int(FETCH_UINT(first_excluded, i + 1));
  LeftOut list = LeftOut(uvec4[](uvec4(i), uvec4(i), uvec4(i)), first + 12, end);
  for (int k = 0; k < 12; ++k)
    if (first + k < end) list.held[k / 4][k % 4] = FETCH_UINT(excluded, first + k);
  return list;
}

bool is_held(LeftOut list, uint j) {
  uvec4 other = uvec4(j);
  return any(equal(list.held[0], other)) || any(equal(list.held[1], other)) || any(equal(list.held[2], other));
}

bool is_in_rest(LeftOut list, uint j) {
  bool found = false;
  for (int at = list.next; at < list.end; ++at)
    if (FETCH_UINT(excluded, at) == j) found = true;
  return found;
}

/// Chains yet to be walked: the first vertex of each. The first ones come first, then chain_end.
struct Chains { uint first[8]; };

/// The chains that hold all vertices within `reach` of x. Cells are twice the reach wide, so these are the eight cells
/// on this vertex's side of its cell. Different cells may share a bucket: its chain is there once, and vertices of
/// other cells in it are too far away to be listed.
Chains chains_near(vec3 x) {
  Chains chains;
  for (int k = 0; k < 8; ++k) chains.first[k] = chain_end;
  ivec3 corner = corner_of(x);
  uint buckets[8];
  for (int at = 0; at < 8; ++at) {
    buckets[at] = bucket_of(corner + ivec3(at & 1, at >> 1 & 1, at >> 2));
    bool known = false;
    for (int k = 0; k < at; ++k) known = known || buckets[k] == buckets[at];
    uint chain = known ? chain_end : FETCH_UINT(head, buckets[at]);
    if (chain != chain_end) {
      for (int k = 7; k > 0; --k) chains.first[k] = chains.first[k - 1];
      chains.first[0] = chain;
    }
  }
  return chains;
}

uint take_chain(inout Chains chains) {
  uint chain = chains.first[0];
  for (int k = 0; k < 7; ++k) chains.first[k] = chains.first[k + 1];
  chains.first[7] = chain_end;
  return chain;
}

void main() {
  int i = first_vertex + int(gl_GlobalInvocationID.x);
  if (i == vertex_count - 1) {  // the last range ends the rebuild until a vertex asks for another
    rebuild_groups = search_on = 0;
    finish_groups = uint((vertex_count + GROUP_SIZE - 1) / GROUP_SIZE);
    ++rebuilds;
  }
  if (i >= vertex_count) return;
  vec3 x = FETCH(position, i).xyz;
  int first = i * NEIGHBOUR_SLOTS;
  LeftOut left_out = left_out_at(i);
  Chains chains = chains_near(x);
  uint j = take_chain(chains);
  int count = 0;
  uint lost = 0;
  // Software OpenGL carries out every line of a loop for all threads of a group as long as one of them goes on,
  // whatever the conditions. So the inner loop has only what finds the next neighbour; what lists it, which is rare,
  // is outside.
  for (;;) {
    uint found = chain_end;
    float gap = 0.0;
    while (j != chain_end && found == chain_end) {
      uvec4 link = FETCH(links, j);
      gap = distance(x, uintBitsToFloat(link.xyz));
      if (gap < reach && j != uint(i) && !is_held(left_out, j)) found = j;
      j = link.w;
      if (j == chain_end) j = take_chain(chains);
    }
    if (found == chain_end) break;
    if (is_in_rest(left_out, found)) continue;
    int slot = count;
    if (count < NEIGHBOUR_SLOTS) ++count;
    else ++lost;
    for (; slot > 0; --slot) {
      uvec2 other = neighbours[first + slot - 1];
      float other_gap = uintBitsToFloat(other.y);
      if (other_gap < gap || (other_gap == gap && other.x < found)) break;
      if (slot < NEIGHBOUR_SLOTS) neighbours[first + slot] = other;
    }
    if (slot < NEIGHBOUR_SLOTS) neighbours[first + slot] = uvec2(found, floatBitsToUint(gap));
  }
  for (int slot = 0; slot < count; ++slot) {
    int j = int(neighbours[first + slot].x);
    neighbours[first + slot].y = floatBitsToUint(min(thickness, rest_distance(i, j)));
  }
  neighbour_count[i] = uint(count);
  if (2 * count > NEIGHBOUR_SLOTS) atomicMax(longest, uint(count) + lost);
  if (lost > 0) atomicAdd(dropped, lost);
}
