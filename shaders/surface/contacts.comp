// Contact, 2 of 4: the pairs that are near at the step's start, how they are apart then, and which of them touch at
// each vertex.
#include "surface.glsl"
#include "vertex_contacts.glsl"
READ_VEC4(position, unit_position);  // after the step
READ_VEC4(step_start, unit_step_start);
READ_UVEC4(pair_list, unit_surface_pairs);
READ_UINT(kept_pairs, unit_chosen_pairs);  // cull.comp
layout(std430, binding = slot_near_pairs) writeonly buffer NearPairs { uvec4 near_list[]; };
layout(std430, binding = slot_chosen_pairs) writeonly buffer Chosen { uint touching_pairs[]; };
layout(std430, binding = slot_pair_loads) writeonly buffer Loads { vec4 pair_loads[]; };  // forces.comp
// Of each corner of each near pair, by 4 * pair + corner: the next contact of the same vertex (VertexContacts::first),
// and the corner's weight, as bits. In what order a vertex has them depends on the order of threads: what is made of
// them must not.
layout(std430, binding = slot_contact_links) writeonly buffer Links { uvec2 contact_links[]; };

void add_touched(uint vertex) {
  uint place = atomicAdd(control.step_counts[turn].touched, 1u);
  if (place % uint(GROUP_SIZE) == 0u) atomicMax(control.step_counts[turn].pushed_groups, place / uint(GROUP_SIZE) + 1u);
  at_vertex[place].touched = vertex;
}

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].kept) return;
  uvec4 pair = FETCH(pair_list, FETCH_UINT(kept_pairs, pair_capacity + gl_GlobalInvocationID.x));
  uvec4 corner = corners_of(pair);
  bool edges = is_edges(pair);
  vec3 start[4];
  for (int k = 0; k < 4; ++k) start[k] = FETCH(step_start, corner[k]).xyz;
  Corners c;
  for (int k = 0; k < 4; ++k) c.x[k] = start[k] - start[0];
  Separation apart = separation(edges, c);
  if (apart.gap < uintBitsToFloat((pair.y & no_force_bit) != 0u ? known.flat_query : known.query)) {
    uint slot = atomicAdd(control.step_counts[turn].near, 1u);
    if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.step_counts[turn].near_groups, slot / uint(GROUP_SIZE) + 1u);
    control.step_counts[turn].vertex_groups = uint((changing_vertex_count + GROUP_SIZE - 1) / GROUP_SIZE);
    vec4 weight = vec4(apart.weight[0], apart.weight[1], apart.weight[2], apart.weight[3]);
    near_list[3u * slot] = pair;
    near_list[3u * slot + 1u] = floatBitsToUint(vec4(apart.n, apart.gap));
    near_list[3u * slot + 2u] = floatBitsToUint(weight);
    vec3 moved = vec3(0.0);
    for (int k = 0; k < 4; ++k) moved += apart.weight[k] * (FETCH(position, corner[k]).xyz - start[k]);
    if ((pair.y & no_force_bit) == 0u && apart.gap + dot(moved, apart.n) < kept_apart(corner, weight)) {
      uint place = atomicAdd(control.step_counts[turn].touching, 1u);
      if (place % uint(GROUP_SIZE) == 0u)
        atomicMax(control.step_counts[turn].touching_groups, place / uint(GROUP_SIZE) + 1u);
      touching_pairs[place] = slot;
      pair_loads[place] = vec4(0.0);
      for (int k = 0; k < 4; ++k)
        if (corner[k] < uint(cloth_vertex_count)) {
          uint contact = 4u * slot + uint(k);
          uint next = atomicExchange(at_vertex[corner[k]].first, contact + 1u);
          contact_links[contact] = uvec2(next, floatBitsToUint(apart.weight[k]));
          if (next == 0u) add_touched(corner[k]);
          atomicAdd(at_vertex[corner[k]].sharing, uint(weight_in_units(apart.weight[k])));
        }
    }
  }
}
