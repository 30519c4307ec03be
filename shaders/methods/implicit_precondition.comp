// Implicit Euler's conjugate gradients, after implicit_collect.comp and implicit_step.comp: the preconditioned
// residual.
#include "implicit_euler.glsl"
#include "implicit_preconditioner.glsl"
READ_VEC4(constraint, unit_constraint);
READ_VEC4(residual, unit_residual);
layout(std430, binding = slot_preconditioned) writeonly buffer Preconditioned { vec4 preconditioned[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  float inverse_mass = FETCH(position, i).w;
  vec3 z = preconditioned_residual(i, FETCH(residual, i).xyz, inverse_mass, FETCH(constraint, i));
  preconditioned[i] = vec4(z, 0.0);
}
