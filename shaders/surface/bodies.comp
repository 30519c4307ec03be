// Places the vertices of bodies, behind those of cloths, where their motions have them at one time of a step.
#include "surface.glsl"
#include "../methods/motions.glsl"
READ_VEC4(body_places, unit_body_places);  // home, motion or -1; friction, restitution, a box's corner
layout(std430, binding = slot_next_position) writeonly buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer Velocity { vec4 velocity[]; };
uniform int row;  // 0: the step's start; END_ROW: its end

void main() {
  int i = int(gl_GlobalInvocationID.x), at = cloth_vertex_count + i;
  if (at >= vertex_count) return;
  vec4 home = FETCH(body_places, 2 * i);
  int motion = int(home.w);
  vec3 x = home.xyz, v = vec3(0.0);
  if (motion >= 0) {
    x = placed(motion, row, home.xyz);
    v = velocity_at(motion, row, x);
  }
  position[at] = vec4(x, 0.0);
  velocity[at] = vec4(v, -1.0);
}
