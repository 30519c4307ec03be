// The filter, 1 of 3, in every step, or piece of one: how far each vertex wants to go, and whether a search must reach
// farther for it. Without near pairs that is the end; else `position` starts over at the start. Also gets the counts
// ready for the next one.
#include "surface.glsl"
#include "vertex_contacts.glsl"
READ_VEC4(position, unit_position);  // at the step's end; w: inverse mass [1/kg]
READ_VEC4(step_start, unit_step_start);
READ_UVEC4(vertex_contacts, unit_vertex_contacts);
layout(std430, binding = slot_next_position) writeonly buffer Position { vec4 next_position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_step_target) writeonly buffer Target { vec4 target[]; };
layout(std430, binding = slot_step_limits) writeonly buffer Limits { uint limits[]; };  // step_limits.glsl

uniform int last_piece;  // 1: of the step

void prepare_next_piece() {
  int next = 1 - turn;
  control.step_counts[next].kept_groups = control.step_counts[next].kept = 0u;
  control.step_counts[next].near_groups = control.step_counts[next].vertex_groups = 0u;
  control.step_counts[next].touching_groups = control.step_counts[next].meeting_groups = 0u;
  control.step_counts[next].pushed_groups = control.step_counts[next].cut_vertices = 0u;
  control.step_counts[next].near = control.step_counts[next].touching = 0u;
  control.step_counts[next].meeting = control.step_counts[next].cuts = control.step_counts[next].touched = 0u;
  control.since = floatBitsToUint(uintBitsToFloat(known.since) + uintBitsToFloat(known.part) * dt);
  if (piece_count == 1) return;
  float gone = uintBitsToFloat(known.gone), part = uintBitsToFloat(known.part);
  gone = part >= 1.0 - gone ? 1.0 : gone + part;
  control.gone = floatBitsToUint(gone);
  control.check_groups = gone < 1.0 ? 1u : 0u;
  if (last_piece != 0 || !(gone < 1.0)) control.longest = 0u;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) prepare_next_piece();
#if MOTION_COUNT > 0
  if (i == 0)
    for (int k = 0; k < MOTION_COUNT; ++k) limits[vertex_count + 2 * k] = floatBitsToUint(1.0);
#endif
  if (i >= changing_vertex_count || !(uintBitsToFloat(known.part) > 0.0)) return;
  vec4 start = FETCH(step_start, i), end = FETCH(position, i);
  bool free = end.w > 0.0, of_cloth = i < cloth_vertex_count, filtered = known.step_counts[turn].near > 0u;
  if (filtered && FETCH(vertex_contacts, 2 * i).x != 0u) {
    if (free) velocity[i].w += 1.0;
    at_vertex[i].first = at_vertex[i].backing = at_vertex[i].sharing = 0u;
  }
  vec3 moved = end.xyz - start.xyz;
  float went = length(moved), query_radius = uintBitsToFloat(known.flat_query), most = step_share * query_radius;
  if (went > 0.9 * most && query_radius < most_query) {
    if (went < 1e30) atomicMax(control.fastest, floatBitsToUint(went));
    control.rebuild_groups = uint((max(vertex_count, triangle_count) + GROUP_SIZE - 1) / GROUP_SIZE);
  }
  if (of_cloth && went > most) {
    end.xyz = start.xyz + moved * (most / went);
    next_position[i] = end;
    atomicAdd(control.step_counts[turn].cuts, 1u);
    atomicAdd(control.cuts, 1u);
  }
  if (of_cloth && known.overflow != 0u) next_position[i] = end = start;
  // Bodies that do not move come here in the first steps alone.
  if (filtered || i >= cloth_vertex_count) target[i] = end;
  if (filtered) next_position[i] = vec4(start.xyz, end.w);
}
