// Contacts within the iteration, after each sweep over the springs. All vertices are handled at once, from where the
// sweep left them, so that no order matters. Several pairs at once would add up to more than is needed: each is divided
// by the larger of the two vertices' contact counts in the pass before, at least 2.
#ifdef SELF_COLLISION
READ_UINT(neighbour_count, unit_neighbour_count);
READ_UVEC2(neighbours, unit_neighbours);
uniform float self_friction;

/// Share of an overlap at the step's start that is removed per second [1/s]: what is removed becomes velocity.
const float mending = 20.0;

/// The push by the vertices that touch this one [m].
vec3 push_of_pairs(int i, vec4 x, vec3 v, vec4 d, inout int touched) {
  vec3 push = vec3(0.0);
  int count = int(FETCH_UINT(neighbour_count, i));
  for (int slot = 0; slot < count; ++slot) {
    uvec2 neighbour = FETCH_UVEC2(neighbours, i * NEIGHBOUR_SLOTS + slot);
    vec4 y = FETCH(position, neighbour.x), e = deviation(neighbour.x);
    // precise: both forms of the kernel are compiled apart and must round alike.
    precise vec3 moved = drift(v - FETCH(velocity, neighbour.x).xyz) + (d.xyz - e.xyz);
    precise vec3 before = x.xyz - y.xyz, now = before + moved;
    vec3 correction;
    if (!pair_contact(before, now, uintBitsToFloat(neighbour.y), self_friction, min(0.2, mending * dt), correction))
      continue;
    ++touched;
    push += (x.w / (x.w + y.w) / max(2.0, max(d.w, e.w))) * correction;
  }
  return push;
}
#endif

void meet(int i) {
  vec4 x = FETCH(position, i), d = deviation(i);
  vec3 v = FETCH(velocity, i).xyz, free = free_displacement(v);
  if (x.w == 0.0) {
    set_deviation(i, d);
    return;
  }
  int touched = 0;
#ifdef SELF_COLLISION
  vec3 push = push_of_pairs(i, x, v, d, touched);
  d.xyz += push;
#ifdef BY_VERTEX
  targets[i].xyz += push;
#endif
#endif
  vec3 wanted = x.xyz + (free + d.xyz), stopped = wanted;
  meet_as(i);
  int met = resolve_colliders(x.xyz, stopped, v, 0.0);
  RARELY(met > 0) {
    vec3 back = stopped - wanted;
    d.xyz += back;
    d.xyz -= friction_displacement(free + d.xyz - dt * met_velocity, met_normal, met_surface.x, dot(back, met_normal));
  }
#if defined(SELF_COLLISION) && defined(BY_VERTEX)
  met = max(met, int(targets[i].w));
#endif
  set_deviation(i, vec4(d.xyz, float(touched + met)));
}
