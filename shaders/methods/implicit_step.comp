// Implicit Euler's conjugate gradients, between the halves of an iteration, in one work group: adds up all sums,
// decides how far the step goes and whether the solve has ended, and solves the coarse level's equations for the new
// residual.
#include "implicit_euler.glsl"
#include "group_sums.glsl"
#include "implicit_control.glsl"
#include "implicit_patches.glsl"
READ_VEC4(patch_sums, unit_patch_sums);  // see implicit_patch_sums.glsl
READ_VEC4(coarse_factor, unit_coarse_factor);  // see server/sim/coarse_factor.h
// For each patch its parts of the residual, a vector for each mode; for each of the direction's product with the
// matrix; for each of the correction [m/s].
layout(std430, binding = slot_coarse_vectors) buffer CoarseVectors { vec4 coarse_vectors[]; };
uniform int iteration;  // -1: none, only the coarse level's equations
uniform float left_share;  // of the first residual times its preconditioned one: see `enough`
uniform float little;  // [J]: a first guess with no more of that product, within the tolerance, is the solution
// Of all unknowns of the coarse level: the residual, and what is between it and the correction.
// Three more fill up the last four.
#define ROOM (PATCH_UNKNOWNS * MOST_PATCHES + 3)
shared float unknowns[ROOM], halfway[ROOM];

void add_up(int patch_number, inout vec4 products, inout vec3 vectors[PATCH_MODES]) {
  int end = patch_list(patch_slots, patch_number + 1);
  for (int k = patch_list(patch_slots, patch_number); k < end; ++k) {
    int at = (1 + PATCH_MODES) * patch_list(slots, k);
    products += FETCH(patch_sums, at);
    for (int mode = 0; mode < PATCH_MODES; ++mode) vectors[mode] += FETCH(patch_sums, at + 1 + mode).xyz;
  }
}

/// A group of patches in the tree. Numbers of unknowns: of the first in all groups below it, of its own, and the end.
struct PatchGroup {
  int first, begin, end;
  int rows, columns;  // where those of the factor begin
  int above;          // the group above it, or -1
};

PatchGroup patch_group(int number) {
  int at = 6 * number;
  return PatchGroup(patch_list(tree, at), patch_list(tree, at + 1), patch_list(tree, at + 2),
                    patch_list(tree, at + 3), patch_list(tree, at + 4), patch_list(tree, at + 5) - 1);
}

/// Solves the coarse level's equations: W^T W times `unknowns`, with W the inverse of the matrix's Cholesky factor. A
/// row of W has columns of its own group and of those below, a column rows of its own group and of those above. A
/// thread does all rows and columns of a patch: in software OpenGL it costs more to get the vector than the matrix.
void solve_coarse_level(int patch_number) {
  bool works = patch_number < patch_count;
  int own = PATCH_UNKNOWNS * patch_number, of_patch = works ? patch_list(group_of, patch_number) : -1;
  float sum[PATCH_UNKNOWNS];
  for (int u = 0; u < PATCH_UNKNOWNS; ++u) sum[u] = 0.0;
  if (works) {
    PatchGroup group = patch_group(of_patch);
    int at = group.rows + own - group.begin;
    for (int k = group.first / 4 * 4; k < own + PATCH_UNKNOWNS; k += 4) {
      vec4 four = vec4(unknowns[k], unknowns[k + 1], unknowns[k + 2], unknowns[k + 3]);
      for (int u = 0; u < PATCH_UNKNOWNS; ++u) sum[u] += dot(FETCH(coarse_factor, at + u), four);
      at += group.end - group.begin;
    }
    for (int u = 0; u < PATCH_UNKNOWNS; ++u) halfway[own + u] = sum[u];
  }
  barrier();
  for (int u = 0; u < PATCH_UNKNOWNS; ++u) sum[u] = 0.0;
  for (int number = of_patch; number >= 0;) {
    PatchGroup group = patch_group(number);
    int at = group.columns + own - group.first;
    for (int k = group.begin / 4 * 4; k < group.end; k += 4) {
      vec4 four = vec4(halfway[k], halfway[k + 1], halfway[k + 2], halfway[k + 3]);
      for (int u = 0; u < PATCH_UNKNOWNS; ++u) sum[u] += dot(FETCH(coarse_factor, at + u), four);
      at += group.end - group.first;
    }
    number = group.above;
  }
  if (!works) return;
  int all = PATCH_MODES * patch_count;
  for (int mode = 0; mode < PATCH_MODES; ++mode)
    coarse_vectors[2 * all + PATCH_MODES * patch_number + mode] =
        vec4(sum[3 * mode], sum[3 * mode + 1], sum[3 * mode + 2], 0.0);
}

void main() {
  int own = int(gl_LocalInvocationID.x);
  float last_product = last, last_step = along;
  vec4 products = vec4(0.0);
  vec3 r[PATCH_MODES] = vec3[](vec3(0.0), vec3(0.0), vec3(0.0));
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
    if (own == 0 && iteration == 0) enough = left_share * now;
    bool met = sum.z <= sum.w || (iteration > 0 ? now <= enough : now <= min(little, sum.w));
    // Or there is no precision left. With contact, whose stiffness differs from pair to pair, a thousandth of two like
    // numbers is their rounding.
#ifdef CONTACT_TERM
    float least_curvature = 1e-3 * sum.y;
#else
    float least_curvature = 0.0;
#endif
    bool ended = met || !(now > 0.0 && curvature > least_curvature);
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
  int at = PATCH_MODES * own, all = PATCH_MODES * patch_count;
  if (own < 3) unknowns[PATCH_UNKNOWNS * patch_count + own] = halfway[PATCH_UNKNOWNS * patch_count + own] = 0.0;
  if (own < patch_count) {
    for (int mode = 0; mode < PATCH_MODES; ++mode) {
      if (iteration >= 0) {
        vec3 q = r[mode];
        if (iteration > 0) q += share * coarse_vectors[all + at + mode].xyz;
        r[mode] = coarse_vectors[at + mode].xyz - step * q;
        coarse_vectors[all + at + mode] = vec4(q, 0.0);
      }
      coarse_vectors[at + mode] = vec4(r[mode], 0.0);
      for (int axis = 0; axis < 3; ++axis) unknowns[3 * (at + mode) + axis] = r[mode][axis];
    }
  }
  barrier();
  solve_coarse_level(own);
}
