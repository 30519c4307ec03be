// Implicit Euler with contact between surfaces, after the line search, in one work group: the share of the change that
// is taken. The host asks for it: only a step that is taken whole can be the last.
#include "implicit_euler.glsl"
#include "group_sums.glsl"
READ_VEC4(group_sums, unit_group_sums);
#define ROWS SUMS
#include "implicit_total.glsl"
#include "implicit_term.glsl"
#include "implicit_share.glsl"

void main() {
  float share = best_share() * most_share();
  if (gl_LocalInvocationID.x == 0) term.taken = floatBitsToUint(share);
}
