// Implicit Euler's conjugate gradients, between the halves of an iteration, in one work group: adds up all sums,
// decides how far the step goes and whether the solve has ended, and solves the coarse level's equations for the new
// residual.
#include "implicit_euler.glsl"
#include "group_sums.glsl"
#include "implicit_control.glsl"
#include "implicit_patches.glsl"
READ_VEC4(patch_sums, unit_patch_sums);  // for each slot those of products, then of vectors
READ_VEC4(coarse_inverse, unit_coarse_inverse);  // for each pair of patches the three rows of its block
// For each patch the sum of the residual, then of the direction's product with the matrix, then the correction [m/s].
layout(std430, binding = slot_coarse_vectors) buffer CoarseVectors { vec4 coarse_vectors[]; };
uniform int iteration;  // -1: none, only the coarse level's equations
shared vec3 coarse_residual[GROUP_SIZE];  // of patch_count patches

void add_up(int patch_number, inout vec4 products, inout vec3 vector) {
  int end = patch_list(patch_slots, patch_number + 1);
  for (int k = patch_list(patch_slots, patch_number); k < end; ++k) {
    int slot = patch_list(slots, k);
    products += FETCH(patch_sums, 2 * slot);
    vector += FETCH(patch_sums, 2 * slot + 1).xyz;
  }
}

void main() {
  int own = int(gl_LocalInvocationID.x);
  float last_product = last, last_step = along;
  vec4 products = vec4(0.0);
  vec3 r = vec3(0.0);
  if (own < patch_count) add_up(own, products, r);
  float step = 0.0, share = 0.0;
  if (iteration >= 0) {
    vec4 sum = sum_of_group(products);  // with barriers: one thread may now write what all have read
    float now = sum.x, curvature = sum.y;
    if (iteration > 0) {
      share = now / last_product;
      curvature -= share * now / last_step;
    }
    step = now / curvature;
    bool met = sum.z <= sum.w;
    bool ended = met || !(now > 0.0 && curvature > 0.0);  // or there is no precision left
    if (own == 0) {
      if (ended) {
        groups = single = 0;
        converged = uint(met);
      } else {
        along = step;
        kept = share;
        last = now;
        iterations = uint(iteration) + 1;
      }
    }
    if (ended) return;
  }
  if (own < patch_count) {
    if (iteration >= 0) {
      vec3 q = r;
      if (iteration > 0) q += share * coarse_vectors[patch_count + own].xyz;
      r = coarse_vectors[own].xyz - step * q;
      coarse_vectors[patch_count + own] = vec4(q, 0.0);
    }
    coarse_vectors[own] = vec4(r, 0.0);
    coarse_residual[own] = r;
  }
  barrier();
  if (own >= patch_count) return;
  vec3 correction = vec3(0.0);
  for (int other = 0; other < patch_count; ++other) {
    int at = 3 * (patch_count * own + other);
    vec3 there = coarse_residual[other];
    correction += vec3(dot(FETCH(coarse_inverse, at).xyz, there), dot(FETCH(coarse_inverse, at + 1).xyz, there),
                       dot(FETCH(coarse_inverse, at + 2).xyz, there));
  }
  coarse_vectors[2 * patch_count + own] = vec4(correction, 0.0);
}
