// Implicit Euler's conjugate gradients, second half of an iteration. Every work group adds up all groups' sums in the
// same order, and so finds the same step and the same decision to stop; then each vertex takes its part of the step.
#include "implicit_euler.glsl"
#include "group_sums.glsl"
READ_VEC4(residual, unit_residual);
READ_VEC4(preconditioned, unit_preconditioned);
READ_VEC4(direction, unit_direction);
READ_VEC4(direction_product, unit_direction_product);
READ_VEC4(change, unit_change);
READ_VEC4(product, unit_product);
READ_VEC4(constraint, unit_constraint);
READ_VEC4(group_sums, unit_group_sums);
READ_VEC4(block_a, unit_block_a);
READ_VEC4(block_b, unit_block_b);
layout(std430, binding = slot_residual) writeonly buffer Residual { vec4 next_residual[]; };
layout(std430, binding = slot_preconditioned) writeonly buffer Preconditioned { vec4 next_preconditioned[]; };
layout(std430, binding = slot_direction) writeonly buffer Direction { vec4 next_direction[]; };
layout(std430, binding = slot_direction_product) writeonly buffer DirectionProduct { vec4 next_direction_product[]; };
layout(std430, binding = slot_change) writeonly buffer Change { vec4 next_change[]; };
layout(std430, binding = slot_solver_control) buffer Control {
  uint groups, groups_y, groups_z;  // of the next iterations' dispatches: 0 once this solve has ended
  uint iterations;                  // of this solve
  uint converged;
  uint unused_1, unused_2, unused_3;
  vec2 steps[];  // for each iteration: residual times preconditioned residual, length of the step
};
uniform int iteration;

/// Adds up all work groups' sums, in every work group.
#if GROUP_COUNT <= 16  // too few groups to be worth a barrier
vec4 total() {
  vec4 sum = vec4(0.0);
  for (int group = 0; group < GROUP_COUNT; ++group) sum += FETCH(group_sums, group);
  return sum;
}
#else
vec4 total() {
  vec4 sum = vec4(0.0);
  for (int group = int(gl_LocalInvocationID.x); group < GROUP_COUNT; group += GROUP_SIZE)
    sum += FETCH(group_sums, group);
  return sum_of_group(sum);
}
#endif

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec4 sum = total();
  float now = sum.x, curvature = sum.y;
  float kept = 0.0;  // share of the last direction in the next one
  if (iteration > 0) {
    vec2 last = steps[iteration - 1];
    kept = now / last.x;
    curvature -= kept * now / last.y;
  }
  bool met = sum.z <= sum.w;
  bool ended = met || !(now > 0.0 && curvature > 0.0);  // or there is no precision left
  float along = now / curvature;
  if (i == 0) {
    if (ended) {
      groups = 0;
      converged = uint(met);
    } else {
      steps[iteration] = vec2(now, along);
      iterations = uint(iteration) + 1;
    }
  }
  if (ended || i >= vertex_count) return;

  vec3 p = FETCH(preconditioned, i).xyz, q = FETCH(product, i).xyz;
  if (iteration > 0) {
    p += kept * FETCH(direction, i).xyz;
    q += kept * FETCH(direction_product, i).xyz;
  }
  vec4 r = FETCH(residual, i);
  r.xyz -= along * q;
  float inverse_mass = FETCH(position, i).w;
  vec4 held = FETCH(constraint, i);
  vec3 z = solve_block(FETCH(block_a, i).xyz, FETCH(block_b, i).xyz, filtered(r.xyz, inverse_mass, held));
  next_change[i] = vec4(FETCH(change, i).xyz + along * p, 0.0);
  next_direction[i] = vec4(p, 0.0);
  next_direction_product[i] = vec4(q, 0.0);
  next_residual[i] = r;
  next_preconditioned[i] = vec4(filtered(z, inverse_mass, held), 0.0);
}
