// Implicit Euler's line search: the change of the incremental potential
//   m/2 |u - v|^2 + elastic(start + dt u) - dt m g.u + dt m drag/2 |u|^2 + dt c/2 sum (n.(u_i - u_j))^2
// for each share of the Newton step. A pin moves its whole way at any share.
#include "implicit_euler.glsl"
#define SUMS_AT_ONCE SUMS
#include "group_sums.glsl"
#ifdef CONTACT_TERM
#include "implicit_term.glsl"
#include "../surface/term_solids.glsl"
READ_VEC4(start_position, unit_start_position);
#include "step_start.glsl"
#else
float most_share(float inverse_mass) { return 1.0; }
#endif
READ_VEC4(start_velocity, unit_start_velocity);
READ_VEC4(change, unit_change);
layout(std430, binding = slot_group_sums) writeonly buffer Sums { vec4 group_sums[]; };  // SUMS per work group

#ifdef FREE
/// xyz: momentum [kg m/s] that gravity and air drag leave the vertex without its springs, less the momentum that it has
/// with the whole change. Springs only pass momentum on, so that the sum should be 0. w: momentum per change of
/// velocity [kg].
vec4 momentum_left_out(int i, vec4 x) {
  vec3 v = FETCH(start_velocity, i).xyz, u = FETCH(velocity, i).xyz + FETCH(change, i).xyz;
  return vec4(v - u + dt * (gravity.xyz - drag(i) * u), 1.0 + dt * drag(i)) / x.w;
}
#endif

// The change of a free corner is scaled, that of a pinned one is not. These are functions because their arguments are
// read in any case: a compiler then sees that a vertex is read once.
vec3 if_pinned(vec3 d, float inverse_mass) { return inverse_mass == 0.0 ? d : vec3(0.0); }
vec3 if_free(vec3 d, float inverse_mass) { return inverse_mass == 0.0 ? vec3(0.0) : d; }

#if defined(CONTACT_TERM) && SOLID_ROWS > 0
/// Adds the change of a solid's energy at each share of the way `moved`, less the work that the solid does, as it goes
/// on in any case (surface/term_energy.comp).
void add_solid(int kind, bool moves, int first, int i, vec4 x, vec3 moved, inout float energy[SHARES]) {
  Solid now, later;
  place_at_iterate(kind, moves, first, most_share(), now, later);
  if (!(solid_entry(kind, now, later, x.xyz, x.xyz + moved, now.radius) <= 1.0)) return;
  if (begins_within(kind, moves, first, step_start(i))) return;
  float stiffness = solid_stiffness(x.w), least = 1e-4 * margin;
  vec3 n, driven = whole_dt * (1.0 - gone) * most_share() * solid_velocity(first, x.xyz);
  float gap = max(margin - nearest_of_solid(kind, now, x.xyz, n), least);
  float before = contact_energy(gap, margin, stiffness), push = contact_force(gap, margin, stiffness) * dot(n, driven);
  for (int k = 0; k < SHARES; ++k) {
    place_at_iterate(kind, moves, first, most_share() * shares[k], now, later);
    gap = max(margin - nearest_of_solid(kind, later, x.xyz + shares[k] * moved, n), least);
    float work = 0.5 * shares[k] * (push + contact_force(gap, margin, stiffness) * dot(n, driven));
    energy[k] += contact_energy(gap, margin, stiffness) - before - work;
  }
}
#endif

void main() {
  int i = int(gl_GlobalInvocationID.x);
  float energy[SHARES];
  for (int k = 0; k < SHARES; ++k) energy[k] = 0.0;
  vec4 x = i < vertex_count ? FETCH(position, i) : vec4(0.0);
  if (i < vertex_count) {
    vec3 u = FETCH(velocity, i).xyz, d = most_share(x.w) * FETCH(change, i).xyz;
    vec3 fixed_change = if_pinned(d, x.w), scaled_change = if_free(d, x.w);
#each Law
    for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
      LawEntry entry = entry_of_Law(at.first);
      LawEdges dx, du, scaled;
      for (int k = 0; k < Law_CORNERS - 1; ++k) {
        vec4 y = FETCH(position, entry.others[k]);
        vec3 dy = most_share(y.w) * FETCH(change, entry.others[k]).xyz;
        vec3 fixed_edge = fixed_change - if_pinned(dy, y.w);
        dx.d[k] = x.xyz - y.xyz + dt * fixed_edge;
        du.d[k] = u - FETCH(velocity, entry.others[k]).xyz + fixed_edge;
        scaled.d[k] = scaled_change - if_free(dy, y.w);
      }
      LawLine line = element_line(entry.law, dx, du, scaled);
      for (int k = 0; k < SHARES; ++k)
        energy[k] += line_energy(entry.law, line, dt, shares[k]) / float(Law_CORNERS);  // others count the rest
    }
#end
    if (x.w > 0.0) {
      float m = 1.0 / x.w;
      float slope = m * dot(d, u - FETCH(start_velocity, i).xyz - dt * gravity.xyz + dt * drag(i) * u);
      float curvature = m * (1.0 + dt * drag(i)) * dot(d, d);
      for (int k = 0; k < SHARES; ++k) energy[k] += shares[k] * (slope + 0.5 * shares[k] * curvature);
#if defined(CONTACT_TERM) && SOLID_ROWS > 0
      meet_as(i);
#define ADD_SOLIDS(kind, moves, first, end) \
  for (int row = first; row < end; row += solid_rows(kind)) add_solid(kind, moves, row, i, x, dt * d, energy);
      EACH_SOLID(ADD_SOLIDS)
#endif
    }
  }
  vec4 sums_of[SUMS];
  sums_of[0] = vec4(energy[0], energy[1], energy[2], energy[3]);
  sums_of[1] = vec4(energy[4], energy[5], energy[6], energy[7]);
#ifdef FREE
  sums_of[2] = i < vertex_count ? momentum_left_out(i, x) : vec4(0.0);
#endif
  sums_of_group(sums_of, false);
  if (gl_LocalInvocationID.x == 0)
    for (int k = 0; k < SUMS; ++k) group_sums[SUMS * gl_WorkGroupID.x + k] = sums_of[k];
}
