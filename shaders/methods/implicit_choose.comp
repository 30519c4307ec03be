// Implicit Euler with contact between surfaces, after the line search, in one work group: the share of the change that
// is taken. The host asks for it: only a step that is taken whole can be the last.
#include "implicit_euler.glsl"
#define SUMS_AT_ONCE SUMS
#include "group_sums.glsl"
READ_VEC4(group_sums, unit_group_sums);
#include "implicit_total.glsl"
#include "implicit_term.glsl"
#include "implicit_share.glsl"

void main() {
  vec4 found[SUMS];
  read_totals(found);
  float share = best_share(found) * most_share();
  if (gl_LocalInvocationID.x == 0) term.taken = floatBitsToUint(share);
}
