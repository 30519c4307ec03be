// VBD: Chen et al. 2024. A visit to a vertex takes one Newton step on implicit Euler's objective with all other
// vertices held (their equation 9), without the part of the Hessian that a compressed spring makes indefinite. A
// collider in the way is met with the vertex's own block: it pushes as hard as it must, and friction follows from that.
#include "blocks.glsl"
READ_UINT(visited, unit_visited);  // free vertices, colour after colour
/// Velocity at the last step's start [m/s]; w: that step's dt [s], or 0 if there is none to use.
layout(std430, binding = slot_velocity_before) buffer VelocityBefore { vec4 velocity_before[]; };
/// Where inertia and wind would take each vertex, as a deviation [m], with the pushes of self-collision since the
/// step's start; w: number of colliders met at the last visit.
layout(std430, binding = slot_targets) coherent buffer Targets { vec4 targets[]; };

#ifdef WIND
/// Displacement of a vertex on which nothing but wind and gravity acts, less that without wind [m]. As under implicit
/// Euler (implicit_wind.comp) the force is linear in the velocity at the step's end, and so adds to the inertia [kg],
/// which is kept with the remainders.
vec3 displacement_by_wind(int i, vec4 x, vec3 v) {
  WindLoad load = wind_on(i, x.xyz, v, wind_velocity(END_ROW));
  float share = mobility * dt * x.w * load.braking;  // added inertia over the vertex's own
  remainders[i].position.w = dt * load.braking;
  precise vec3 gain = x.w * load.force - share * (gravity.xyz - gravity.w * v);
  return drift(dt * gain) / (1.0 + share);
}
#endif

/// Whether a vertex falls freely, [0, 1]: 1 if its acceleration was `pull` but for two hundredths, 0 if but for a tenth
/// or more. Chen et al. (section 3.7) have the share of the pull that it has followed instead. But what sweeps make of
/// a guess is the next one's acceleration, so such a share follows the true one late where sweeps are few, and a pull
/// that comes late feeds a swing, for ever.
float falls(vec3 acceleration, vec3 pull) {
  vec3 other = acceleration - pull;
  float squared = dot(pull, pull);
  return squared > 0.0 ? clamp((0.1 - sqrt(dot(other, other) / squared)) / 0.08, 0.0, 1.0) : 1.0;
}

/// The first guess: inertia's motion, with gravity's and the wind's where the vertex falls freely, so that a cloth at
/// rest starts from rest. If its free motion meets a collider, the guess is that motion stopped there, with friction,
/// and of both the part along the surface: sweeps move a stiff cloth so little that one on a slope would stay where it
/// was.
vec3 first_deviation(int i, vec4 x, vec3 v) {
  vec4 before = velocity_before[i];
  velocity_before[i] = vec4(v, dt);
  targets[i] = vec4(remainder(i), 0.0);
  vec3 felt = (v / mobility - before.xyz) / (before.w > 0.0 ? before.w : dt);
  vec3 pull = gravity.xyz, back = vec3(0.0), sliding = vec3(0.0);
  vec3 free = free_displacement(v);
#ifdef WIND
  vec3 blown = displacement_by_wind(i, x, v);
  targets[i].xyz += blown;
  pull += blown / (mobility * dt * dt);
  free += blown;
#endif
  vec3 stopped = x.xyz + free, unused = v;
  meet_as(i);
  int met = resolve_colliders(x.xyz, stopped, unused, 0.0);
  RARELY(met > 0) {
    back = met_normal * dot(stopped - (x.xyz + free), met_normal);
    pull -= met_normal * dot(pull, met_normal);
    felt -= met_normal * dot(felt, met_normal);
    sliding = free + back - dt * met_velocity;
    vec3 taken = friction_displacement(sliding, met_normal, met_surface.x, dot(back, met_normal));
    felt += taken / (mobility * dt * dt);  // without friction it would have followed by that much more
    // The change of velocity in an impact says nothing of the next step.
    if (hits(v)) velocity_before[i].w = 0.0;
  }
  float share = before.w == 0.0 ? 1.0 : falls(felt, pull);
  vec3 less = drift(dt * (share - 1.0) * pull);
  RARELY(met > 0) back -= friction_displacement(sliding + less, met_normal, met_surface.x, dot(back, met_normal));
#ifdef WIND
  less += blown;
#endif
  return less + back;
}

/// Stops the step of a vertex, x + d to x + d + descent, at the colliders; a, b: its block. Returns the number of
/// colliders met.
int stop(vec3 x, vec3 d, vec3 a, vec3 b, inout vec3 descent) {
  vec3 wanted = x + d + descent, stopped = wanted, v = vec3(0.0);
  int met = resolve_colliders(x, stopped, v, 0.0);
  RARELY(met > 0) {
    float depth = dot(stopped - wanted, met_normal);
    vec3 give = solve_block(a, b, met_normal);
    float impulse = depth / dot(met_normal, give);
    descent += impulse * give;
    vec3 sliding = d + descent - dt * met_velocity;
    sliding -= met_normal * dot(met_normal, sliding);
    float distance_slid = length(sliding);
    vec3 along = sliding / max(distance_slid, 1e-30);
    // Friction moves the vertex along the surface only.
    vec3 response = solve_block(a, b, along);
    response -= give * (dot(met_normal, response) / dot(met_normal, give));
    float most = met_surface.x * impulse;
    descent -= dot(along, response) * most < distance_slid ? response * most : sliding;
  }
  return met;
}

void visit_vertex(int item) {
  int i = int(FETCH_UINT(visited, item));
  vec4 x = FETCH(position, i);
  float inertia = 1.0 / (x.w * mobility);
#ifdef WIND
  inertia += remainders[i].position.w;
#endif
  vec3 v = FETCH(velocity, i).xyz, d = deviation(i).xyz;
  // precise: both forms of the kernel are compiled apart and must round alike.
  precise vec3 residual = inertia * (targets[i].xyz - d), diagonal = vec3(inertia), corner = vec3(0.0);
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges place, moved;
    for (int k = 0; k < Law_CORNERS - 1; ++k) {
      int j = entry.others[k];
      moved.d[k] = drift(v - FETCH(velocity, j).xyz) + (d - deviation(j).xyz);
      place.d[k] = (x.xyz - FETCH(position, j).xyz) + moved.d[k];
    }
    add_descent(entry.law, dt, place, moved, residual, diagonal, corner);
  }
#end
  vec3 a, b;
  factorise(diagonal, corner, inertia, a, b);
  precise vec3 descent = solve_block(a, b, residual);
  meet_as(i);
  int met = stop(x.xyz, free_displacement(v) + d, a, b, descent);
#ifdef SELF_COLLISION
  targets[i].w = float(met);
  set_deviation(i, d + descent);
#else
  set_deviation(i, vec4(d + descent, float(met)));
#endif
}
