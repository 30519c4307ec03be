// Implicit Euler's conjugate gradients, before the first iteration and every few ones: the residual's sum over each
// patch.
#include "implicit_euler.glsl"
#include "implicit_patch_sums.glsl"
READ_VEC4(constraint, unit_constraint);
READ_VEC4(residual, unit_residual);

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec3 r = vec3(0.0);
  if (i < vertex_count) r = filtered(FETCH(residual, i).xyz, FETCH(position, i).w, FETCH(constraint, i));
  write_patch_sums(vec4(0.0), r);
}
