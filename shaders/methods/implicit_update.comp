// Implicit Euler's conjugate gradients, second half of an iteration: each vertex takes its part of the step.
#include "implicit_euler.glsl"
#include "implicit_control.glsl"
#include "implicit_preconditioner.glsl"
READ_VEC4(residual, unit_residual);
READ_VEC4(preconditioned, unit_preconditioned);
READ_VEC4(direction, unit_direction);
READ_VEC4(direction_product, unit_direction_product);
READ_VEC4(change, unit_change);
READ_VEC4(product, unit_product);
READ_VEC4(constraint, unit_constraint);
layout(std430, binding = slot_residual) writeonly buffer Residual { vec4 next_residual[]; };
layout(std430, binding = slot_preconditioned) writeonly buffer Preconditioned { vec4 next_preconditioned[]; };
layout(std430, binding = slot_direction) writeonly buffer Direction { vec4 next_direction[]; };
layout(std430, binding = slot_direction_product) writeonly buffer DirectionProduct { vec4 next_direction_product[]; };
layout(std430, binding = slot_change) writeonly buffer Change { vec4 next_change[]; };
uniform int iteration;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec3 p = FETCH(preconditioned, i).xyz, q = FETCH(product, i).xyz;
  if (iteration > 0) {
    p += kept * FETCH(direction, i).xyz;
    q += kept * FETCH(direction_product, i).xyz;
  }
  vec4 r = FETCH(residual, i);
  r.xyz -= along * q;
  next_change[i] = vec4(FETCH(change, i).xyz + along * p, 0.0);
  next_direction[i] = vec4(p, 0.0);
  next_direction_product[i] = vec4(q, 0.0);
  next_residual[i] = r;
  vec3 z = preconditioned_residual(i, r.xyz, FETCH(position, i).w, FETCH(constraint, i));
  next_preconditioned[i] = vec4(z, 0.0);
}
