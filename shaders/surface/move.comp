// The filter, 3 of 3: takes the shortened steps, in place; with `last`, also the impulses.
#include "surface.glsl"
#include "vertex_contacts.glsl"
READ_VEC4(step_target, unit_step_target);
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_step_limits) buffer Limits { uint limits[]; };
uniform int last;
uniform float held_part;  // as in limit.comp

/// A vertex that takes less than this of its step is jammed between others: what its springs give it would add up, step
/// after step, until it comes free. It loses half of its speed in a step.
const float jammed_share = 0.1;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= changing_vertex_count) return;
  vec4 goal = FETCH(step_target, i);
  bool free = position[i].w > 0.0;
  float share = free ? uintBitsToFloat(limits[i]) : held_part;
  vec3 x = position[i].xyz;
  if (share < 1.0 && free) {
    float size = length(goal.xyz - x);
    if (share * size < shortest_part * rounding_at(x, size)) share = 0.0;
  }
  position[i].xyz = share < 1.0 ? x + share * (goal.xyz - x) : goal.xyz;
  if (share < 1.0 && free) {
    limits[i] = floatBitsToUint(1.0);
    if (last != 0) {
      atomicAdd(control.step_counts[turn].cuts, 1u);
      atomicAdd(control.cuts, 1u);
      if (share < jammed_share) velocity[i].xyz *= 0.5;
    }
  }
  if (at_vertex[i].shortening != 0u) {
    if (last != 0)
      for (int k = 0; k < 3; ++k) {
        velocity[i][k] += float(at_vertex[i].impulse[k]) / units_of_speed();
        at_vertex[i].impulse[k] = 0;
      }
    at_vertex[i].shortening = 0u;
  }
}
