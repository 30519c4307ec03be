// Contact, 3 of 3: the pushes on each vertex, in place. A solid that it is pushed into stops it, with friction: so what
// lies on a solid carries what lies on it.
#include "surface.glsl"
#include "../methods/motions.glsl"
#include "../collide/colliders.glsl"
READ_VEC4(step_start, unit_step_start);
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_contact_sums) buffer Sums { int sums[]; };
// 1: from now on only those pairs share a vertex that pushed it in this pass. In the first passes too many others may
// begin to.
uniform int recount;
// What a pass does with the friction that a solid has left over for the vertices that it bears: 0, nothing, as no pass
// of friction alone follows; 1, the first of a step, counts it from zero; 2, counts on; 3, friction alone, uses it too.
uniform int solid_friction;

/// The solid that has borne a vertex last, and what its friction may still take of sliding on it in this step.
struct Borne {
  vec4 normal;    // w: of displacement [m]
  vec4 velocity;  // the solid's [m/s]; w: of velocity [m/s]
};
layout(std430, binding = slot_borne) buffer BorneBySolids { Borne borne[]; };

/// Before friction a solid has moved the vertex by `back` [m] and changed its velocity by `change` [m/s], which has
/// friction in it.
void count_friction(int i, vec3 back, vec3 change) {
  FrictionLeft left = FrictionLeft(borne[i].normal.w, borne[i].velocity.w);
  float stopped = dot(change, met_normal);
  left.displacement += met_surface.x * max(dot(back, met_normal), 0.0) - length(met_braking);
  left.velocity += met_surface.x * max(stopped, 0.0) - length(change - met_normal * stopped);
  borne[i] = Borne(vec4(met_normal, max(left.displacement, 0.0)), vec4(met_velocity, max(left.velocity, 0.0)));
}

void stop_at_solids(int i) {
  vec3 start = FETCH(step_start, i).xyz, x = position[i].xyz, v = velocity[i].xyz;
  met_braking = vec3(0.0);
  int met = 0;
  // A solid that moves is where the step takes it, but a piece ends before the step does.
#if SOLID_ROWS > 0
#define STOP(kind, moves, first, end)                                \
  if (!moves || piece_count == 1)                                    \
    for (int row = first; row < end; row += solid_rows(kind))        \
      met += meet_solid(kind, moves, row, start, x, v, 0.0);
  EACH_SOLID(STOP)
#endif
  RARELY(met > 0) {
    if (solid_friction != 0) count_friction(i, x - position[i].xyz, v - velocity[i].xyz);
    position[i].xyz = x - met_braking;
    velocity[i].xyz = v;
  }
}

void rub_on_solid(int i) {
  Borne on = borne[i];
  FrictionLeft left = FrictionLeft(on.normal.w, on.velocity.w);
  if (!(left.displacement > 0.0 || left.velocity > 0.0)) return;
  vec3 moved = position[i].xyz - FETCH(step_start, i).xyz - dt * on.velocity.xyz;
  position[i].xyz -= rub(moved, on.normal.xyz, 1.0, left.displacement);
  velocity[i].xyz -= rub(velocity[i].xyz - on.velocity.xyz, on.normal.xyz, 1.0, left.velocity);
  borne[i].normal.w = left.displacement;
  borne[i].velocity.w = left.velocity;
}

void main() {
  int i = int(gl_GlobalInvocationID.x), first = SUMS * i;
  if (i >= changing_vertex_count || sums[first + 3] == 0) return;
  position[i].xyz += vec3(sums[first], sums[first + 1], sums[first + 2]) / units_of_length();
  velocity[i].xyz += vec3(sums[first + 4], sums[first + 5], sums[first + 6]) / units_of_speed();
  for (int k = 0; k < 3; ++k) sums[first + k] = sums[first + 4 + k] = 0;
  RARELY(recount != 0) sums[first + 3] = max(1, sums[first + 15]);  // 0 would say that no pair touches it
  sums[first + 15] = 0;
  float weight = float(sums[first + 11]) / weight_units;
  RARELY(weight > 0.0) {
    position[i].xyz += vec3(sums[first + 8], sums[first + 9], sums[first + 10]) / (units_of_length() * weight);
    velocity[i].xyz += vec3(sums[first + 12], sums[first + 13], sums[first + 14]) / (units_of_speed() * weight);
    for (int k = 8; k < 15; ++k) sums[first + k] = 0;
  }
  if (solid_friction == 1) borne[i] = Borne(vec4(0.0), vec4(0.0));
  RARELY(position[i].w > 0.0) {
    stop_at_solids(i);
    if (solid_friction == 3) rub_on_solid(i);
  }
}
