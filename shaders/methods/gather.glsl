// Shared by every kernel of a method: the vertex's state, the forces of its elements, the motion of its pin.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
uniform int vertex_count;
#include "../elements/lists.glsl"
#include "motions.glsl"

READ_VEC4(position, unit_position);  // w: inverse mass [1/kg], 0 if pinned
READ_VEC4(velocity, unit_velocity);  // w: contacts of the last step; for a pinned vertex its motion's index or -1
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
uniform float dt;      // [s]
#include "step_time.glsl"
uniform vec4 gravity;  // xyz [m/s^2], w: air drag [1/s]

vec3 element_forces(int i, vec3 x, vec3 v) {
  vec3 force = vec3(0.0);
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges dx, dv;
    for (int k = 0; k < Law_CORNERS - 1; ++k) {
      int j = entry.others[k];
      dx.d[k] = x - FETCH(position, j).xyz;
      dv.d[k] = v - FETCH(velocity, j).xyz;
    }
    force += element_force(entry.law, dx, dv);
  }
#end
  return force;
}

#include "wind.glsl"

/// Acceleration by elements, gravity, air drag and wind [m/s^2]. `row`: of the wind, counted from the step's start.
vec3 acceleration(int i, vec4 x, vec3 v, int row) {
  vec3 a = element_forces(i, x.xyz, v) * x.w + gravity.xyz - gravity.w * v;
#ifdef WIND
  a += wind_acceleration(i, x, v, wind_velocity(row));
#endif
  return a;
}

#ifdef PINS_WAIT
const float catch_up = 1.0;  // how much faster than its motion a pin goes that contact held back [m/s]

/// A pin that is behind its motion (shaders/surface/limit.comp) comes after it without a jump. `way`: of the motion
/// since the step's start [m].
void catch_up_from(vec3 start, float way, inout vec3 x, inout vec3 v) {
  vec3 missing = x - start;
  float most = way + whole_dt * catch_up, left = length(missing);
  if (left > most) {
    x = start + missing * (most / left);
    v = (x - start) / whole_dt;
  }
}
#endif

/// State of a pinned vertex, by its motion: at the pose table's row `row`, counted from the step's start, where it is
/// at `start`.
void follow_motion(int i, vec3 start, float motion_index, int row, out vec3 x, out vec3 v) {
  vec3 home = FETCH(rest_position, i).xyz;
  int motion = int(motion_index);
  x = motion < 0 ? home : placed(motion, row, home);
  v = motion < 0 ? vec3(0.0) : velocity_at(motion, row, x);
#ifdef PINS_WAIT
  catch_up_from(start, motion < 0 ? 0.0 : distance(x, placed(motion, 0, home)), x, v);
#endif
}
