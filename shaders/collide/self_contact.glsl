// Self-collision of the vertex with those of its neighbour list that are too close: pushes the two apart and takes out
// the approaching velocity, each its share by inverse mass, with Coulomb friction. Both vertices compute the same
// contact with the same scale, so momentum is kept. Needs neighbours.glsl's lists, contact.glsl, position, velocity.
READ_UINT(neighbour_count, 4);
READ_UVEC2(neighbours, 5);
layout(location = 4) uniform float self_friction;

/// Adds to push [m] and impulse (change of velocity [m/s]); returns the number of vertices touched.
/// Several contacts at once would add up to more than is needed: each is scaled by the larger of the two vertices'
/// contact counts of the step before (kept in velocity.w), at least 2.
int self_contacts(int i, vec4 x, vec4 v, inout vec3 push, inout vec3 impulse) {
  int touched = 0;
  int count = int(FETCH_UINT(neighbour_count, i));
  for (int slot = 0; slot < count; ++slot) {
    uvec2 neighbour = FETCH_UVEC2(neighbours, i * NEIGHBOUR_SLOTS + slot);
    vec4 y = FETCH(position, neighbour.x);
    vec3 d = x.xyz - y.xyz;
    float keep = uintBitsToFloat(neighbour.y);
    float gap_squared = dot(d, d);
    if (!(gap_squared < keep * keep) || !(gap_squared > 0.0)) continue;
    ++touched;
    float gap = sqrt(gap_squared);
    vec3 n = d / gap;
    vec4 w = FETCH(velocity, neighbour.x);
    float others = y.w > 0.0 ? w.w : 0.0;  // a pinned vertex keeps its motion's index there
    float share = x.w / (x.w + y.w) / max(2.0, max(v.w, others));
    vec3 relative = v.xyz - w.xyz;
    push += share * (keep - gap) * n;
    impulse += share * (contact_velocity(relative, n, self_friction, 0.0) - relative);
  }
  return touched;
}
