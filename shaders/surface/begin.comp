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

READ_VEC4(step_velocity, unit_step_velocity);  // at the step's start

uniform int last_piece;  // 1: of the step; what is left of it then is not taken

void prepare_next_piece() {
  int next = 1 - turn;
  control.step_counts[next].kept_groups = control.step_counts[next].kept = 0u;
  control.step_counts[next].near_groups = control.step_counts[next].vertex_groups = 0u;
  control.step_counts[next].touching_groups = control.step_counts[next].meeting_groups = 0u;
  control.step_counts[next].pushed_groups = control.step_counts[next].cut_vertices = 0u;
  control.step_counts[next].near = control.step_counts[next].touching = 0u;
  control.step_counts[next].meeting = control.step_counts[next].cuts = control.step_counts[next].touched = 0u;
  control.since = floatBitsToUint(uintBitsToFloat(known.since) + uintBitsToFloat(known.part) * dt);
  float gone = uintBitsToFloat(known.gone), part = uintBitsToFloat(known.part);
  gone = part >= 1.0 - gone ? 1.0 : gone + part;
  if (piece_count == 1) gone = pairs_are_known() ? 1.0 : 0.0;
  if (last_piece != 0 && gone < 1.0) {
    atomicAdd(control.not_taken, 1u);
    atomicAdd(control.forced, 1u);
  }
  if (piece_count == 1) return;
  control.gone = floatBitsToUint(gone);
  control.check_groups = gone < 1.0 ? 1u : 0u;
  if (last_piece != 0 || !(gone < 1.0)) control.longest = control.longest_of_bodies = 0u;
}

/// None of the step is taken: a vertex has the velocity that it had at the step's start.
void take_none(int i, bool free) {
  if (free && i < cloth_vertex_count) velocity[i].xyz = FETCH(step_velocity, i).xyz;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) prepare_next_piece();
#if MOTION_COUNT > 0
  if (i == 0)
    for (int k = 0; k < MOTION_COUNT; ++k) limits[vertex_count + 2 * k] = floatBitsToUint(1.0);
#endif
  if (i >= changing_vertex_count) return;
  vec4 start = FETCH(step_start, i), end = FETCH(position, i);
  bool free = end.w > 0.0;
  if (!(uintBitsToFloat(known.part) > 0.0)) {
    if (last_piece != 0 && !(uintBitsToFloat(known.gone) > 0.0)) take_none(i, free);
    return;
  }
  bool of_cloth = i < cloth_vertex_count, filtered = known.step_counts[turn].near > 0u;
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
  if (of_cloth && !pairs_are_known()) {  // of a step in pieces nothing has been taken (advance.comp)
    next_position[i] = end = vec4(start.xyz, end.w);
    take_none(i, free);
  }
  if (!of_cloth && went > step_share * uintBitsToFloat(known.query)) atomicAdd(control.forced, 1u);
  // Bodies that do not move come here in the first steps alone.
  if (filtered || i >= cloth_vertex_count) target[i] = end;
  if (filtered) next_position[i] = vec4(start.xyz, end.w);
}
