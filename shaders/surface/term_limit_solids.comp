// Contact's term: the largest share of the way that keeps every vertex out of the solids, one for all, as
// term_limit.comp has it.
#include "term.glsl"
#include "../methods/motions.glsl"
#include "term_solids.glsl"
#include "term_kept.glsl"
READ_VEC4(position, unit_position);      // w: inverse mass [1/kg]
READ_VEC4(way, unit_term_way);
READ_VEC4(term_start, unit_term_start);  // places at the step's start

void limit(int kind, bool moves, int first, vec4 x, vec3 moved, vec3 start, inout float share, inout bool meets) {
  Solid now, later;
  place_at_iterate(kind, moves, first, 1.0, now, later);
  float gap = margin - solid_depth(kind, now, x.xyz), core = now.radius - margin;
  if (!(solid_entry(kind, now, later, x.xyz, x.xyz + moved, now.radius) <= 1.0)) return;
  if (begins_within(kind, moves, first, start)) return;
  meets = true;
  float keep = kept(gap, margin, rounding_at(x.xyz, length(moved)));
  float entry = solid_entry(kind, now, later, x.xyz, x.xyz + moved, core + keep);
  if (!(entry < 1.0)) entry = 1.0;
  // A solid that turns is not where the estimate has it.
  for (int again = 0; again < 6 && moves; ++again) {
    place_at_iterate(kind, moves, first, entry, now, later);
    if (margin - solid_depth(kind, later, x.xyz + entry * moved) >= 0.5 * keep) break;
    entry *= 0.5;
  }
  share = min(share, entry);
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= cloth_vertex_count) return;
  vec4 x = FETCH(position, i);
  if (x.w == 0.0) return;
  vec3 moved = FETCH(way, i).xyz, start = FETCH(term_start, i).xyz;
  float share = 1.0;
  bool meets = false;
  meet_as(i);
#if SOLID_ROWS > 0
#define LIMIT(kind, moves, first, end) \
  for (int row = first; row < end; row += solid_rows(kind)) limit(kind, moves, row, x, moved, start, share, meets);
  EACH_SOLID(LIMIT)
#endif
  if (share < 1.0) atomicMin(term.share, floatBitsToUint(share));
  if (meets) {
    atomicAdd(term.meets, 1u);
    atomicMax(term.pressed, floatBitsToUint(min(length(moved), 1e30)));
  }
}
