// Contact, 2 of 3: pushes of the near pairs that touch, on the places and velocities that the step, or the pass before, has made.
// Each corner takes its share by inverse mass and weight, which keeps momentum.
#include "surface.glsl"
#include "near_pairs.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_start, unit_step_start);
uniform float friction;
uniform float mend;  // share of an overlap that a pass removes

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].touching) return;
  uint item = chosen_pairs[gl_GlobalInvocationID.x];
  uvec4 pair = FETCH(near_pairs, 3u * item);
  vec4 apart = uintBitsToFloat(FETCH(near_pairs, 3u * item + 1u));
  vec4 weight = uintBitsToFloat(FETCH(near_pairs, 3u * item + 2u));
  uvec4 corner = corners_of(pair);
  vec3 moved = vec3(0.0), v = vec3(0.0);
  vec4 mobility;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    moved += weight[k] * (x.xyz - FETCH(step_start, corner[k]).xyz);
    v += weight[k] * FETCH(velocity, corner[k]).xyz;
    mobility[k] = weight[k] * x.w;
  }
  float give = dot(mobility, weight);
  vec3 push, impulse;
  RARELY(give > 0.0 && surface_contact(apart.xyz, apart.w, moved, v, thickness, friction, mend, push, impulse)) {
    float share = 1.0 / (give * crowd(corner, mobility, 3));
    push *= share * units_of_length();
    impulse *= share * units_of_speed();
    for (int k = 0; k < 4; ++k)
      if (mobility[k] != 0.0) {
        add(corner[k], 0, mobility[k] * push);
        add(corner[k], 4, mobility[k] * impulse);
      }
  }
}
