// Contact's term: the pairs that press at the iterate, with their force, stiffness and friction, linked at the vertices
// that they touch.
#include "term.glsl"
#include "term_radius.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_VEC4(step_start, unit_step_start);
READ_UVEC4(pair_list, unit_surface_pairs);
READ_UINT(chosen, unit_chosen_pairs);          // term_cull.comp
READ_VEC4(body_places, unit_body_places);      // home, motion; friction, restitution, a box's corner
READ_VEC4(ends, unit_term_ends);               // of bodies, behind the places of cloths
READ_VEC4(way, unit_term_way);                 // to the last iterate's target
uniform float friction;     // of cloths
uniform int bodies_move;    // 1: some have yet to go
READ_VEC4(step_velocity, unit_step_velocity);  // at the step's start
#include "term_add.glsl"

float friction_of(uvec4 corner) {
  int body = int(max(corner.x, corner.w)) - cloth_vertex_count;
  return body >= 0 ? FETCH(body_places, 2 * body + 1).x : friction;
}

void main() {
  if (gl_GlobalInvocationID.x >= term.kept.w) return;
  uvec4 pair = FETCH(pair_list, FETCH_UINT(chosen, pair_capacity + gl_GlobalInvocationID.x)), corner = corners_of(pair);
  bool edges = is_edges(pair);
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c;
  vec4 inverse_mass;
  float size = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    c.x[k] = x.xyz - origin;
    inverse_mass[k] = x.w;
    size = max(size, length(c.x[k]));
  }
  Separation apart = separation(edges, c);
  float radius = radius_of(pair);
  if (!(apart.gap < radius)) return;
  float least = rounding_at(origin, size);
  Pressing pressing;
  pressing.pair = pair;
  pressing.corner = corner;
  pressing.inverse_mass = inverse_mass;
  pressing.n = apart.n;
  pressing.gap = max(apart.gap, least);
  pressing.radius = radius;
  pressing.stiffness = stiffness_of(inverse_mass);
  pressing.friction = friction_of(corner);
  pressing.least = least;
  pressing.moved = pressing.to_come = pressing.expected = pressing.last = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    vec3 x = FETCH(position, corner[k]).xyz;
    pressing.weight[k] = apart.weight[k];
    pressing.moved += apart.weight[k] * (x - FETCH(step_start, corner[k]).xyz);
    if (last_share > 0.0) pressing.last += apart.weight[k] * last_share * FETCH(way, corner[k]).xyz;
    pressing.expected += apart.weight[k] * (whole_dt * FETCH(step_velocity, corner[k]).xyz);
    if (bodies_move != 0 && int(corner[k]) >= cloth_vertex_count)
      pressing.to_come += apart.weight[k] * (FETCH(ends, corner[k]).xyz - x) / dt;
  }
  add(pressing);
}
