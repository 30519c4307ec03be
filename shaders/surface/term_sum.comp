// Contact's term: sums the changes of energy, of the pairs that may press on the way or, with OF_FRICTION, of friction.
#include "term.glsl"
READ_VEC4(energies, unit_term_energies);

void main() {
  uint item = gl_GlobalInvocationID.x;
#if OF_FRICTION
  if (item >= term.pressing.w) return;
#else
  if (item >= term.reachable.w) return;
#endif
  vec4 change = FETCH(energies, item);
  for (int s = 0; s < 4; ++s) {
    float largest = max(uintBitsToFloat(term.largest[s]), 1e-30);
    ivec2 units = in_units(change[s] / largest);
    if (units == ivec2(0)) continue;
    atomicAdd(term.high[s], units.x);
    atomicAdd(term.low[s], uint(units.y));
  }
}
