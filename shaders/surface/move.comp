// The filter, 3 of 3: takes the shortened steps, in place; with LAST, the last time in a step or piece, also the
// impulses.
#include "surface.glsl"
#include "vertex_contacts.glsl"
#include "step_limits.glsl"
#include "../methods/motions.glsl"
#define SOLIDS_IN_PIECES
#include "../collide/colliders.glsl"
READ_VEC4(position, unit_position);  // so far; w: inverse mass [1/kg]
READ_VEC4(step_target, unit_step_target);
READ_UVEC4(vertex_contacts, unit_vertex_contacts);
READ_UINT(step_limits, unit_step_limits);
layout(std430, binding = slot_next_position) writeonly buffer Position { vec4 moved_position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_step_limits) writeonly buffer Limits { uint limits[]; };
uniform float held_part;  // as in limit.comp
uniform float margin;     // at which solids keep vertices [m]

/// A vertex that takes less than this of its step is jammed between others: what its springs give it would add up, step
/// after step, until it comes free. It loses half of its speed in a step.
const float jammed_share = 0.1;

#if LAST
#include "speed_units.glsl"

/// True if a solid that moves has come over a place where the filter keeps a vertex.
bool within_moving_solid(vec3 x) {
#if SOLID_ROWS > 0
  if (piece_count > 1) piece_end = uintBitsToFloat(known.gone);
#endif
  return depth_in_moving_solids(x, -margin) > 0.0;
}

void count_cut(int i, vec3 x, float share, bool pinned) {
  atomicAdd(control.step_counts[turn].cuts, 1u);
  atomicAdd(control.cuts, 1u);
  bool jammed = share < jammed_share;
  if (pinned) velocity[i].xyz *= share;
  else if (jammed) velocity[i].xyz *= 0.5;
  if (pinned ? jammed : within_moving_solid(x)) atomicAdd(control.forced, 1u);
}

void take_impulses(int i) {
  for (int k = 0; k < 3; ++k) {
    velocity[i][k] += float(at_vertex[i].impulse[k]) / units_of_speed();
    at_vertex[i].impulse[k] = 0;
  }
}
#endif

/// A step around a solid, of which a vertex takes a share, may end within the solid: then it takes none. Solids yield
/// half of their margin, or what lies on one could not slide.
bool ends_in_solid(vec3 x, vec3 there) {
  float depth = depth_in_solids_at_rest(there, -0.5 * margin);
  return depth > 0.0 && depth > depth_in_solids_at_rest(x, -0.5 * margin);
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
#if MOTION_COUNT > 0
  if (i == 0)
    for (int k = 0; k < MOTION_COUNT; ++k) limits[vertex_count + 2 * k + 1 - pass % 2] = floatBitsToUint(1.0);
#endif
  if (i >= changing_vertex_count) return;
  vec4 goal = FETCH(step_target, i), x = FETCH(position, i);
  bool moves_by_itself = x.w == 0.0;
  float part = moves_by_itself ? held_part : 1.0;
  float tag = moves_by_itself ? velocity[i].w : -1.0;
  float share = uintBitsToFloat(FETCH_UINT(step_limits, limit_of(i, x.w, tag)));
  bool cut = share < 1.0;
  vec3 way = part * (goal.xyz - x.xyz);
  if (cut) {
    float size = length(way);
    if (share * size < shortest_part * rounding_at(x.xyz, size)) share = 0.0;
#if SOLID_ROWS > 0
    if (!moves_by_itself && ends_in_solid(x.xyz, x.xyz + share * way)) share = 0.0;
#endif
    limits[i] = floatBitsToUint(1.0);
  }
  vec3 there = min(share, part) < 1.0 ? x.xyz + share * way : goal.xyz;
  moved_position[i] = vec4(there, x.w);
#if LAST
  if (cut) count_cut(i, there, share, moves_by_itself);
#endif
  if (FETCH(vertex_contacts, 2 * i + 1).w != 0u) {
#if LAST
    take_impulses(i);
#endif
    at_vertex[i].shortening = 0u;
  }
}
