// Implicit Euler, once per Newton step: the residual of the first guess, and each vertex's block of the matrix,
// factorised. In the first Newton step also the trends of the motion.
#include "implicit_euler.glsl"
#include "touching.glsl"
READ_VEC4(start_velocity, unit_start_velocity);
READ_VEC4(constraint, unit_constraint);
READ_VEC4(change, unit_change);
// Not filtered; w: the vertex's share of the residual that may remain.
layout(std430, binding = slot_residual) writeonly buffer Residual { vec4 residual[]; };
layout(std430, binding = slot_block_a) writeonly buffer BlockA { vec4 block_a[]; };
layout(std430, binding = slot_block_b) writeonly buffer BlockB { vec4 block_b[]; };
READ_VEC4(before_velocity, unit_before_velocity);  // the state at the step's start
layout(std430, binding = slot_trends) writeonly buffer Trends { vec4 trends[]; };  // TRENDS per vertex, filtered
// TRENDS per vertex: the velocities at the starts of the last steps, the newest first; w: 0 if it is not known.
layout(std430, binding = slot_past_velocities) buffer Past { vec4 past_velocities[]; };
uniform float tolerance;  // relative, of the residual
uniform bool first;       // the first Newton step of the time step
uniform bool exact;       // the estimate is the state at the step's start

/// Allowed residual of the vertex, squared and over its mass [J]: relative to its own energy and to what forces add in
/// one step. It is not less than a tenth of the error that rounding the estimate makes in forces: a float of size x is
/// off by 2.4e-8 x, the root of the mean square over all floats. A tenth, because rounding errors of neighbours
/// cancel, and what is left of the residual may push them all the same way. An estimate that is the state at the
/// step's start counts as exact. `in_product` [kg m/s]: what rounding the guess makes in the matrix times it.
float good_enough(float inverse_mass, vec3 v, vec3 force, float stiffness, float damping, vec3 x, vec3 u,
                  float in_product) {
  float own = (dot(v, v) + dt * dt * dot(gravity.xyz, gravity.xyz)) / inverse_mass +
              dt * dt * inverse_mass * dot(force, force);
  float rounding = exact ? 0.0 : 2.4e-9 * dt * (stiffness * length(x) + damping * length(u));
  return tolerance * tolerance * own + inverse_mass * rounding * rounding + inverse_mass * in_product * in_product;
}

void write_trends(int i, float inverse_mass, vec4 held) {
  vec3 now = FETCH(before_velocity, i).xyz;
  vec4 last = past_velocities[TRENDS * i], second = past_velocities[TRENDS * i + 1];
  vec4 third = past_velocities[TRENDS * i + 2];
  vec3 trend[TRENDS] = vec3[](last.w * (now - last.xyz - whole_dt * gravity.xyz),
                              second.w * (now - 2.0 * last.xyz + second.xyz),
                              third.w * (now - 3.0 * (last.xyz - second.xyz) - third.xyz));
  for (int t = 0; t < TRENDS; ++t) trends[TRENDS * i + t] = vec4(filtered(trend[t], inverse_mass, held), 0.0);
  past_velocities[TRENDS * i] = vec4(now, 1.0);
  past_velocities[TRENDS * i + 1] = last;
  past_velocities[TRENDS * i + 2] = second;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 u = FETCH(velocity, i).xyz, d = FETCH(change, i).xyz;
  vec3 force = vec3(0.0), product = vec3(0.0), diagonal = vec3(0.0), corner = vec3(0.0);
  float stiffness = 0.0, damping = 0.0;
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges dx, du, dd;
    for (int k = 0; k < Law_CORNERS - 1; ++k) {
      int j = entry.others[k];
      dx.d[k] = x.xyz - FETCH(position, j).xyz;
      du.d[k] = u - FETCH(velocity, j).xyz;
      dd.d[k] = d - FETCH(change, j).xyz;
    }
    LawMatrix matrix = step_matrix(element_hessian(entry.law, dx), dt);
    force += element_force(entry.law, dx, du);
    stiffness += element_stiffness(entry.law);
    damping += element_damping(entry.law);
    product += matrix_product(matrix, dd);
    add_block(matrix, diagonal, corner);
  }
#end
#ifdef CONTACT_TERM
  uvec2 listed = FETCH_UVEC2(term_vertices, i);
  for (uint place = listed.x; place < listed.x + listed.y; ++place) {
    Touch t = touch_at(place);
    vec3 relative = t.to_come;
    for (int c = 0; c < 4; ++c)
      if (int(t.corner[c]) < vertex_count) relative += t.weight[c] * FETCH(change, t.corner[c]).xyz;
    force += t.force;
    product += touch_product(t, relative);
    float own = dt * dt * t.own * t.own, more = own * (t.along - t.across);
    diagonal += own * t.across + more * t.n * t.n;
    corner += more * vec3(t.n.x * t.n.y, t.n.x * t.n.z, t.n.y * t.n.z);
    float less = own * t.slid.w;
    diagonal -= less * t.slid.xyz * t.slid.xyz;
    corner -= less * vec3(t.slid.x * t.slid.y, t.slid.x * t.slid.z, t.slid.y * t.slid.z);
  }
#endif
  vec4 held = FETCH(constraint, i);
  if (first) write_trends(i, x.w, held);
  if (x.w == 0.0) {
    residual[i] = block_a[i] = block_b[i] = vec4(0.0);
    return;
  }
  float m = 1.0 / x.w, inertia = m * (1.0 + dt * drag(i));
  vec3 v = FETCH(start_velocity, i).xyz;
  vec3 r = m * (v - u + dt * (gravity.xyz - drag(i) * u)) + dt * force - inertia * d - product;

  vec3 a, b;
  factorise(diagonal + inertia, corner, inertia, a, b);
  block_a[i] = vec4(a, 0.0);
  block_b[i] = vec4(b, 0.0);
  float in_product = 0.0;
#ifdef CONTACT_TERM  // whose stiffness is far more than the cloth's
  in_product = 2.4e-8 * length(d) * max(diagonal.x, max(diagonal.y, diagonal.z));
#endif
  residual[i] = vec4(r, good_enough(x.w, v, force, stiffness, damping, x.xyz, u, in_product));
}
