// Self-collision of a vertex with those of its neighbour list that would come too close within this step: takes out the
// approaching velocity that is more than the room between them, with Coulomb friction, and pushes apart what is too close
// already, each vertex its share by inverse mass. Both vertices compute the same contact with the same scale, so momentum
// is kept. Speculative contacts: Catto 2013. Needs neighbours.glsl, contact.glsl, position, velocity, dt.
READ_UINT(neighbour_count, 4);
READ_UVEC2(neighbours, 5);
layout(location = 4) uniform float self_friction;

// The part of an overlap mended in one step. All of it at once would stretch the springs and so add energy.
const float mended = 0.2;

/// Adds to push [m] and impulse (change of velocity [m/s]); returns the number of vertices touched.
/// Several contacts at once would add up to more than is needed: each is scaled by the larger of the two vertices'
/// contact counts of the step before (kept in velocity.w), at least 2.
int self_contacts(int i, vec4 x, vec4 v, inout vec3 push, inout vec3 impulse) {
  int touched = 0;
  int count = int(FETCH_UINT(neighbour_count, i));
  for (int slot = 0; slot < count; ++slot) {
    uvec2 neighbour = FETCH_UVEC2(neighbours, i * NEIGHBOUR_SLOTS + slot);
    vec4 y = FETCH(position, neighbour.x);
    vec4 w = FETCH(velocity, neighbour.x);
    vec3 d = x.xyz - y.xyz;
    float gap = length(d);
    if (!(gap > 0.0)) continue;  // no direction
    vec3 n = d / gap;
    float room = gap - uintBitsToFloat(neighbour.y);
    vec3 relative = v.xyz - w.xyz + n * (max(room, 0.0) / dt);
    if (room >= 0.0 && dot(relative, n) >= 0.0) continue;
    ++touched;
    float others = y.w > 0.0 ? w.w : 0.0;  // a pinned vertex keeps its motion's index there
    float share = x.w / (x.w + y.w) / max(2.0, max(v.w, others));
    push += share * mended * max(-room, 0.0) * n;
    impulse += share * (contact_velocity(relative, n, self_friction, 0.0) - relative);
  }
  return touched;
}
