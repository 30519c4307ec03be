// Before a step: a damped spring from each held vertex to its hand, in the form of backward Euler. With h = dt^2 k/m +
// dt c/m the step's equation
//   m (v' - v - dt g) = dt f + dt k (there - x - dt v') - dt c v'
// is that of a vertex of mass m (1 + h) that enters the step with another velocity. So every method, implicit ones and
// constraints too, takes the spring into its own step without knowing of it, and no stiffness is too large: mass that
// is added makes no vibration faster. (An explicit spring would need dt^2 k/m < 4 of symplectic Euler less what the
// cloth takes of that.)
#include "hands.glsl"
uniform float dt;
uniform vec3 gravity;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= held_count) return;
  Held entry = held[i];
  uint vertex = entry.vertex;
  vec3 way = entry.pull.xyz - position[vertex].xyz;
  way *= min(1.0, entry.numbers.y / max(length(way), 1e-30));
  float heavier = dt * (dt * entry.pull.w + entry.numbers.x);
  vec3 v = velocity[vertex].xyz;
  velocity[vertex].xyz = v + (dt * entry.pull.w * way - heavier * (v + dt * gravity)) / (1.0 + heavier);
  position[vertex].w = entry.numbers.z / (1.0 + heavier);
}
