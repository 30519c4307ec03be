// Contact between surfaces in the matrix of a step: the pairs that press a vertex (surface/term_lists.comp), each with
// the second derivative of its energy, h n n' + f (1 - n n'), times the weights of its corners.
#ifdef CONTACT_TERM
READ_UVEC4(term_pairs, unit_term_pairs);
READ_UVEC2(term_vertices, unit_term_vertices);
READ_UINT(term_entries, unit_term_entries);

/// A pair as one of its corners sees it (surface/term.glsl: pair_texels).
struct Touch {
  uvec4 corner;
  vec4 weight;
  vec3 n;
  float along, across;  // stiffness along n, and of friction across it [N/m]
  vec3 force;           // on this corner [N]
  vec3 to_come;         // the relative velocity that bodies bring [m/s]
  vec4 slid;            // unit vector of what has slid, and by how much less the stiffness is along it [N/m]
  float own;            // this corner's weight
};

Touch touch_at(uint place) {
  uint entry = FETCH_UINT(term_entries, place), at = 6u * (entry / 4u);
  vec4 normal = uintBitsToFloat(FETCH(term_pairs, at + 1u)), force = uintBitsToFloat(FETCH(term_pairs, at + 3u));
  Touch t;
  t.corner = FETCH(term_pairs, at) & 0x7fffffffu;
  t.weight = uintBitsToFloat(FETCH(term_pairs, at + 2u));
  t.n = normal.xyz;
  t.along = normal.w;
  t.across = force.w;
  t.own = t.weight[entry % 4u];
  t.force = t.own * force.xyz;
  vec4 to_come = uintBitsToFloat(FETCH(term_pairs, at + 5u));
  vec3 slid = uintBitsToFloat(FETCH(term_pairs, at + 4u).xyz);
  t.to_come = to_come.xyz;
  t.slid = to_come.w > 0.0 ? vec4(normalize(slid), to_come.w) : vec4(0.0);
  return t;
}

/// The matrix of a pair times the relative velocity of its nearest points, for this corner.
vec3 touch_product(Touch t, vec3 relative) {
  return dt * dt * t.own *
         (t.across * relative + (t.along - t.across) * dot(t.n, relative) * t.n -
          t.slid.w * dot(t.slid.xyz, relative) * t.slid.xyz);
}

/// Adds to `sum` what the pairs at vertex i multiply of a vector of each vertex: `fetch(j)`.
#define ADD_TOUCHES(i, fetch, sum)                                                       \
  {                                                                                      \
    uvec2 listed = FETCH_UVEC2(term_vertices, i);                                        \
    for (uint place = listed.x; place < listed.x + listed.y; ++place) {                  \
      Touch touch = touch_at(place);                                                     \
      vec3 relative = vec3(0.0);                                                         \
      for (int c = 0; c < 4; ++c)                                                        \
        if (int(touch.corner[c]) < vertex_count) relative += touch.weight[c] * fetch(touch.corner[c]); \
      sum += touch_product(touch, relative);                                             \
    }                                                                                    \
  }
#else
#define ADD_TOUCHES(i, fetch, sum) {}
#endif
