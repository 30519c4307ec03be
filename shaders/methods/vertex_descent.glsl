// VBD: Chen et al. 2024. A visit to a vertex takes one Newton step on implicit Euler's objective with all other vertices held
// (their equation 9), the part of the Hessian that a compressed spring makes indefinite left out. A collider in the way is
// met with the vertex's own block: it pushes as hard as it must, and friction follows from that.
#include "blocks.glsl"
READ_UINT(visited, 12);  // free vertices, colour after colour
layout(std430, binding = 6) buffer VelocityBefore { vec4 velocity_before[]; };  // at the last step's start; w: 0 if there was none
/// Where inertia would have each vertex, in the terms of its deviation: pushed by self-collision since the step's start [m];
/// w: colliders met at the last visit.
layout(std430, binding = 5) coherent buffer Targets { vec4 targets[]; };

/// Their adaptive guess (section 3.7): as much of gravity as the vertex has followed of late, so that a cloth at rest starts
/// from rest. Nearly all counts as all: what rounding cuts off at 1 would brake a falling cloth, step after step.
vec3 first_deviation(int i, vec3 v) {
  vec4 before = velocity_before[i];
  velocity_before[i] = vec4(v, 1.0);
  targets[i] = vec4(remainder(i), 0.0);
  float squared = dot(gravity.xyz, gravity.xyz);
  if (before.w == 0.0 || squared == 0.0) return vec3(0.0);
  float share = dot(v / mobility - before.xyz, gravity.xyz) / (dt * squared);
  float followed = clamp(1.02 * share, 0.0, 1.0);
  return drift(dt * (followed - 1.0) * gravity.xyz);
}

/// Stops the step of a vertex, x + d to x + d + descent, at the colliders; a, b: its block. Returns how many it meets.
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
    float taken = min(distance_slid, met_surface.x * impulse * dot(along, solve_block(a, b, along)));
    descent -= along * taken;
  }
  return met;
}

void visit(int item) {
  int i = int(FETCH_UINT(visited, item));
  vec4 x = FETCH(position, i);
  float inertia = 1.0 / (x.w * mobility);
  vec3 v = FETCH(velocity, i).xyz, d = deviation(i).xyz;
  // precise: both forms of the kernel, compiled apart, are to round alike.
  precise vec3 residual = inertia * (targets[i].xyz - d), diagonal = vec3(inertia), corner = vec3(0.0);
  SpringRange range = spring_range(i);
  for (int entry = range.first; entry < range.end; entry += SLICE_SIZE) {
    uvec4 s = FETCH(springs, entry);
    vec3 moved = drift(v - FETCH(velocity, s.x).xyz) + (d - deviation(s.x).xyz), n;
    vec3 apart = (x.xyz - FETCH(position, s.x).xyz) + moved;
    float rest_length = uintBitsToFloat(s.y), damping = dt * uintBitsToFloat(s.w), along, across;
    spring_hessian(apart, vec3(0.0), rest_length, uintBitsToFloat(s.z), n, along, across);
    along *= dt * dt;
    across = dt * dt * max(across, 0.0);
    residual -= (along * (dot(n, apart) - rest_length) + damping * dot(n, moved)) * n;
    precise float more = along + damping - across;
    diagonal += across + more * n * n;
    corner += more * n.xxy * n.yzz;
  }
  vec3 a, b;
  factorise(diagonal, corner, inertia, a, b);
  precise vec3 descent = solve_block(a, b, residual);
  int met = stop(x.xyz, free_displacement(v) + d, a, b, descent);
#ifdef SELF_COLLISION
  targets[i].w = float(met);
  set_deviation(i, d + descent);
#else
  set_deviation(i, vec4(d + descent, float(met)));
#endif
}
