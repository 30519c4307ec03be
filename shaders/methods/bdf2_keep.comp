// BDF2, after a step's solve: what the next step needs of it, and whether the motion is smooth. It is not where contact
// begins: at a vertex that touches more than in the step before, and whose velocity has changed by more than gravity
// gives in two steps. Nor where the wind takes a vertex along within the step: it could take a quarter of the flow's
// speed in it, and the vertex has gained more than that.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "motions.glsl"
#include "step_time.glsl"
uniform int vertex_count;
uniform float impact;  // the least change of velocity of one [m/s]
READ_VEC4(position, unit_position);  // at the step's end; w: inverse mass
READ_VEC4(velocity, unit_velocity);  // the same; w: number of vertices and colliders touched
READ_VEC4(before_position, unit_before_position);
READ_VEC4(before_velocity, unit_before_velocity);
READ_VEC4(history, unit_history);  // as bdf2.glsl has it, of the step before
#ifdef WIND
READ_VEC4(wind_loads, unit_wind);  // w: drag [1/s]
#endif
#ifdef CONTACT_TERM
READ_UVEC2(term_vertices, unit_term_vertices);  // y: pairs that press
#endif
layout(std430, binding = slot_history) writeonly buffer History { vec4 next_history[]; };
layout(std430, binding = slot_met) writeonly buffer Met { uint met; };  // 1: the motion is not smooth

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 gain = v.xyz - FETCH(before_velocity, i).xyz;
  float touched = 0.0;
  if (x.w > 0.0) {
    touched = v.w;
#ifdef CONTACT_TERM
    touched += float(FETCH_UVEC2(term_vertices, i).y);
#endif
    if (touched > FETCH(history, 2 * i).w && length(gain) > impact) met = 1u;
#ifdef WIND
    float flow = length(wind_velocity(END_ROW) - FETCH(before_velocity, i).xyz);
    if (whole_dt * FETCH(wind_loads, i).w > 0.25 && length(gain) > 0.25 * flow) met = 1u;
#endif
  }
  next_history[2 * i] = vec4(x.xyz - FETCH(before_position, i).xyz, touched);
  next_history[2 * i + 1] = vec4(gain, 0.0);
}
