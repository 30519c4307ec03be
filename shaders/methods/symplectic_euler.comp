// One step of symplectic (semi-implicit) Euler: v += a dt, then x += v dt. Hairer, Lubich & Wanner 2006, section I.1.
// Everything a vertex needs is gathered in this one dispatch: springs, gravity, air drag, self-collision from the
// neighbour lists, then pins and colliders on the way to the new position.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "../elements/types.glsl"
#include "../elements/spring.glsl"
#include "../elements/contact.glsl"
#include "../collide/spring_lists.glsl"
#include "motions.glsl"
#include "../collide/colliders.glsl"

READ_VEC4(position, 0);  // w: inverse mass [1/kg], 0 if pinned
READ_VEC4(velocity, 1);  // w: contacts of the last step; of a pinned vertex, its motion's index or -1
READ_VEC4(rest_position, 7);  // w: the cloth
layout(std430, binding = 0) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = 1) writeonly buffer NextVelocity { vec4 next_velocity[]; };
layout(location = 0) uniform int vertex_count;
layout(location = 2) uniform float dt;        // [s]
layout(location = 3) uniform vec4 gravity;    // xyz [m/s^2], w: air drag [1/s]
#ifdef SELF_COLLISION
#include "../collide/neighbours.glsl"
#include "../collide/self_contact.glsl"
READ_VEC4(position_when_built, 8);
layout(location = 5) uniform float skin;  // [m]
#endif

vec3 spring_forces(int i, vec3 x, vec3 v) {
  vec3 force = vec3(0.0);
  SpringRange range = spring_range(i);
  for (int entry = range.first; entry < range.end; entry += GROUP_SIZE) {
    uvec4 s = FETCH(springs, entry);
    force += spring_force(x, FETCH(position, s.x).xyz, v, FETCH(velocity, s.x).xyz, uintBitsToFloat(s.y),
                          uintBitsToFloat(s.z), uintBitsToFloat(s.w));
  }
  return force;
}

/// A pinned vertex is where its motion takes it.
void follow_motion(int i, vec4 v, out vec3 x_next, out vec3 v_next) {
  vec3 home = FETCH(rest_position, i).xyz;
  int motion = int(v.w);
  x_next = motion < 0 ? home : placed(motion, 1, home);
  v_next = motion < 0 ? vec3(0.0) : velocity_at(motion, 1, x_next);
}

/// A free vertex: forces, then velocity, then position. Returns how many things it touches.
int integrate(int i, vec4 x, vec4 v, out vec3 x_next, out vec3 v_next) {
  vec3 acceleration = spring_forces(i, x.xyz, v.xyz) * x.w + gravity.xyz - gravity.w * v.xyz;
  vec3 push = vec3(0.0), impulse = vec3(0.0);
  int contacts = 0;
#ifdef SELF_COLLISION
  contacts = self_contacts(i, x, v, push, impulse);
#endif
  v_next = v.xyz + dt * acceleration + impulse;
  x_next = x.xyz + push + dt * v_next;
  return contacts + resolve_colliders(x.xyz, x_next, v_next);
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 x_next, v_next;
  float tag = v.w;
  if (x.w == 0.0) follow_motion(i, v, x_next, v_next);
  else tag = float(integrate(i, x, v, x_next, v_next));
  next_position[i] = vec4(x_next, x.w);
  next_velocity[i] = vec4(v_next, tag);
#ifdef SELF_COLLISION
  vec3 moved = x_next - FETCH(position_when_built, i).xyz;
  if (dot(moved, moved) > 0.25 * skin * skin) rebuild_groups = gl_NumWorkGroups.x;
#endif
}
