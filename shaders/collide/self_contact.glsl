// Self-collision of a vertex with those of its neighbours that it touches within this step (elements/contact.glsl).
// Each of the two takes its share by inverse mass; both compute the same contact, so momentum is kept.
// START_POSITION and START_VELOCITY name the state at the step's start if that is not position and velocity.
// CONTACT_TIME names the time that they have [s], if that is not dt.
// Needs neighbours.glsl, contact.glsl, position, velocity, dt.
#ifndef START_POSITION
#define START_POSITION position
#define START_VELOCITY velocity
#endif
#ifndef CONTACT_TIME
#define CONTACT_TIME dt
#endif
READ_UINT(neighbour_count, unit_neighbour_count);
READ_UVEC2(neighbours, unit_neighbours);
uniform float self_friction;

/// Adds to push [m] and impulse (change of velocity [m/s]); returns the number of vertices touched.
/// Several contacts at once would add up to more than is needed: each is divided by the larger of the two vertices'
/// contact counts in the step before (kept in velocity.w), at least 2.
int self_contacts(int i, vec4 x, vec4 v, inout vec3 push, inout vec3 impulse) {
  int touched = 0;
  int count = int(FETCH_UINT(neighbour_count, i));
  for (int slot = 0; slot < count; ++slot) {
    uvec2 neighbour = FETCH_UVEC2(neighbours, i * NEIGHBOUR_SLOTS + slot);
    vec4 y = FETCH(START_POSITION, neighbour.x);
    vec4 w = FETCH(START_VELOCITY, neighbour.x);
    vec3 apart, change;
    if (!self_contact(x.xyz, y.xyz, v.xyz, w.xyz, uintBitsToFloat(neighbour.y), self_friction, CONTACT_TIME, apart,
                      change))
      continue;
    ++touched;
    float others = y.w > 0.0 ? w.w : 0.0;  // w of a pinned vertex is its motion's index
    float share = x.w / (x.w + y.w) / max(2.0, max(v.w, others));
    push += share * apart;
    impulse += share * change;
  }
  return touched;
}
