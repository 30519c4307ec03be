// Implicit Euler's preconditioner: each vertex's own block of the matrix, and the coarse level.
#include "implicit_patches.glsl"
READ_VEC4(block_a, unit_block_a);
READ_VEC4(block_b, unit_block_b);
READ_VEC4(coarse_vectors, unit_coarse_vectors);

/// `r`: the residual, not filtered.
vec3 preconditioned_residual(int i, vec3 r, float inverse_mass, vec4 held) {
  vec3 own = solve_block(FETCH(block_a, i).xyz, FETCH(block_b, i).xyz, filtered(r, inverse_mass, held));
  int at = PATCH_MODES * (2 * patch_count + patch_list(patch_of, i));
  vec2 share = patch_shares(i);
  vec3 correction = FETCH(coarse_vectors, at).xyz + share.x * FETCH(coarse_vectors, at + 1).xyz +
                    share.y * FETCH(coarse_vectors, at + 2).xyz;
  return filtered(own + correction, inverse_mass, held);
}
