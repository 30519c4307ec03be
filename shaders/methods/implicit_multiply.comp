// Implicit Euler's conjugate gradients, first half of an iteration: the matrix times the preconditioned residual, and
// all sums of an iteration at once: Chronopoulos & Gear 1989.
#include "implicit_euler.glsl"
#include "implicit_patch_sums.glsl"
#include "touching.glsl"
READ_VEC4(constraint, unit_constraint);
READ_VEC4(residual, unit_residual);
READ_VEC4(preconditioned, unit_preconditioned);
layout(std430, binding = slot_product) writeonly buffer Product { vec4 product[]; };

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
#define PRECONDITIONED(j) FETCH(preconditioned, j).xyz
  ADD_TOUCHES(i, PRECONDITIONED, result)
  return result;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec4 products = vec4(0.0);
  vec3 filtered_product = vec3(0.0);
  if (i < vertex_count) {
    vec4 x = FETCH(position, i), r = FETCH(residual, i);
    vec3 w = vec3(0.0);
    if (x.w > 0.0) {
      vec4 held = FETCH(constraint, i);
      vec3 z = FETCH(preconditioned, i).xyz, left = filtered(r.xyz, x.w, held);
      w = multiply(i, x, z);  // z is filtered: so are its products with w and r
      products = vec4(dot(r.xyz, z), dot(w, z), x.w * dot(left, left), r.w);
      filtered_product = filtered(w, x.w, held);
    }
    product[i] = vec4(w, 0.0);
  }
  write_patch_sums(products, filtered_product);
}
