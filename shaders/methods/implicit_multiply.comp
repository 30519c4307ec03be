// Implicit Euler's conjugate gradients, first half of an iteration: the matrix times the preconditioned residual, and
// the sums that the second half needs. As both sums are made at once, an iteration takes two dispatches: Chronopoulos &
// Gear 1989.
#include "implicit_euler.glsl"
#include "group_sums.glsl"
READ_VEC4(constraint, unit_constraint);
READ_VEC4(residual, unit_residual);
READ_VEC4(preconditioned, unit_preconditioned);
layout(std430, binding = slot_product) writeonly buffer Product { vec4 product[]; };
layout(std430, binding = slot_group_sums) writeonly buffer Sums { vec4 group_sums[]; };  // one per work group

vec3 multiply(int i, vec4 x, vec3 z) {
  vec3 result = z * ((1.0 + dt * drag(i)) / x.w);
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges dx, dz;
    for (int k = 0; k < Law_CORNERS - 1; ++k) {
      int j = entry.others[k];
      dx.d[k] = x.xyz - FETCH(position, j).xyz;
      dz.d[k] = z - FETCH(preconditioned, j).xyz;
    }
    result += matrix_product(step_matrix(element_hessian(entry.law, dx), dt), dz);
  }
#end
  return result;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec4 sum = vec4(0.0);
  if (i < vertex_count) {
    vec4 x = FETCH(position, i), r = FETCH(residual, i);
    vec3 w = vec3(0.0);
    if (x.w > 0.0) {
      vec3 z = FETCH(preconditioned, i).xyz, left = filtered(r.xyz, x.w, FETCH(constraint, i));
      w = multiply(i, x, z);  // z is filtered: so are its products with w and r
      sum = vec4(dot(r.xyz, z), dot(w, z), x.w * dot(left, left), r.w);
    }
    product[i] = vec4(w, 0.0);
  }
  vec4 total = sum_of_group(sum);
  if (gl_LocalInvocationID.x == 0) group_sums[gl_WorkGroupID.x] = total;
}
