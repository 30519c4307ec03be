// Contact's term: the vertices that solids press at the iterate, as pairs (term_pairs.comp) of which all corners are
// the vertex, with the weights 1, 0, 0, 0.
#include "term.glsl"
#include "term_radius.glsl"
#include "../methods/motions.glsl"
#include "term_solids.glsl"
READ_VEC4(position, unit_position);    // w: inverse mass [1/kg]
READ_VEC4(term_start, unit_term_start);  // places at the step's start
READ_VEC4(step_velocity, unit_step_velocity);  // at the step's start
READ_VEC4(way, unit_term_way);                 // to the last iterate's target
uniform float last_gone;                       // share of the step that solids have gone in the last change
#include "term_add.glsl"

void press(int kind, bool moves, int first_row, int i, vec4 x, vec3 start) {
  Solid now, later;
  place_at_iterate(kind, moves, first_row, 0.0, now, later);
  vec3 n;
  float gap = margin - nearest_of_solid(kind, now, x.xyz, n);
  if (!(gap < margin) || begins_within(kind, moves, first_row, start)) return;
  float least = rounding_at(x.xyz, 0.0);
  vec3 moving = solid_velocity(first_row, x.xyz);
  Pressing pressing;
  pressing.corner = pressing.pair = uvec4(i);
  pressing.weight = vec4(1.0, 0.0, 0.0, 0.0);
  pressing.inverse_mass = vec4(x.w);
  pressing.n = n;
  pressing.gap = max(gap, least);
  pressing.radius = margin;
  pressing.stiffness = solid_stiffness(x.w);
  pressing.friction = solids[first_row + 2].x;
  pressing.least = least;
  pressing.moved = x.xyz - start - whole_dt * gone * moving;
  pressing.expected = whole_dt * (FETCH(step_velocity, i).xyz - moving);
  pressing.last = vec3(0.0);
  if (last_share > 0.0) pressing.last = last_share * FETCH(way, i).xyz - whole_dt * last_gone * moving;
  pressing.to_come = -(1.0 - gone) * (whole_dt / dt) * moving;
  add(pressing);
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= cloth_vertex_count) return;
  vec4 x = FETCH(position, i);
  if (x.w == 0.0) return;
  vec3 start = FETCH(term_start, i).xyz;
  meet_as(i);
#if SOLID_ROWS > 0
#define PRESS(kind, moves, first, end) \
  for (int row = first; row < end; row += solid_rows(kind)) press(kind, moves, row, i, x, start);
  EACH_SOLID(PRESS)
#endif
}
