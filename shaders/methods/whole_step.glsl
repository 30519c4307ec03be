// A step in one dispatch. It gathers everything that a vertex needs: springs, gravity, air drag and self-collision from
// the neighbour lists; then pins, and colliders on the way to the new position. The method supplies
//   void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next)
// from the acceleration a and what self-collision adds to position and velocity, and
//   void end(int i, int met, inout vec3 v_next)
// which is called at the step's end, after the vertex met `met` colliders.
#include "../collide/colliders.glsl"
#ifdef SELF_COLLISION
#include "../collide/self_contact.glsl"
#endif

void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next);
void end(int i, int met, inout vec3 v_next);

/// Moves a free vertex. Returns the number of things that it touches.
int move_freely(int i, vec4 x, vec4 v, out vec3 x_next, out vec3 v_next) {
  vec3 a = acceleration(i, x, v.xyz, 0);
  vec3 push = vec3(0.0), impulse = vec3(0.0);
  int contacts = 0;
#ifdef SELF_COLLISION
  contacts = self_contacts(i, x, v, push, impulse);
#endif
  integrate(i, x, v.xyz, a, push, impulse, x_next, v_next);
  meet_as(i);
  int met = resolve_colliders(x.xyz, x_next, v_next, 0.0);
  x_next -= met_braking;
  end(i, met, v_next);
  return contacts + met;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 x_next, v_next;
  float tag = v.w;
  if (x.w == 0.0) follow_motion(i, x.xyz, v.w, END_ROW, x_next, v_next);
  else tag = float(move_freely(i, x, v, x_next, v_next));
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}
