// Contact, 4 of 4: the pushes on each vertex, in place. A solid that it is pushed into stops it, with friction: so what
// lies on a solid carries what lies on it.
#include "surface.glsl"
#include "vertex_contacts.glsl"
#include "../methods/motions.glsl"
#define SOLIDS_IN_PIECES
#include "../collide/colliders.glsl"
READ_VEC4(step_start, unit_step_start);
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
READ_UVEC4(vertex_contacts, unit_vertex_contacts);
READ_UVEC2(contact_links, unit_contact_links);   // contacts.comp
READ_VEC4(contact_pushes, unit_contact_pushes);  // forces.comp
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

/// Returns 0 if none has met it, 1 if one has, 2 if that one presses (least_pressing).
int stop_at_solids(int i) {
  vec3 start = FETCH(step_start, i).xyz, x = position[i].xyz, v = velocity[i].xyz;
  met_braking = vec3(0.0);
  int met = 0;
#if SOLID_ROWS > 0
  piece_begin = uintBitsToFloat(known.gone);
  piece_end = piece_begin + uintBitsToFloat(known.part);
#define STOP(kind, moves, first, end) met += meet_run(kind, moves, first, end, start, x, v, 0.0);
  EACH_SOLID(STOP)
#endif
  if (met > 0) {
    if (solid_friction != 0) count_friction(i, x - position[i].xyz, v - velocity[i].xyz);
    position[i].xyz = x - met_braking;
    velocity[i].xyz = v;
  }
  return met == 0 ? 0 : dot(met_velocity, met_normal) > least_pressing ? 2 : 1;
}

void rub_on_solid(int i) {
  Borne on = borne[i];
  FrictionLeft left = FrictionLeft(on.normal.w, on.velocity.w);
  if (!(left.displacement > 0.0 || left.velocity > 0.0)) return;
  vec3 moved = position[i].xyz - FETCH(step_start, i).xyz - dt * uintBitsToFloat(known.part) * on.velocity.xyz;
  position[i].xyz -= rub(moved, on.normal.xyz, 1.0, left.displacement);
  velocity[i].xyz -= rub(velocity[i].xyz - on.velocity.xyz, on.normal.xyz, 1.0, left.velocity);
  borne[i].normal.w = left.displacement;
  borne[i].velocity.w = left.velocity;
}

/// Sums over the contacts of a vertex. A part that meets one which gives no way must do all of it: a vertex that
/// several such pairs push takes their mean, weighted by how near their contact is to it.
struct Pushes {
  ivec3 push, impulse;          // of pairs whose parts both give way [units of length, of speed]
  ivec3 push_one, impulse_one;  // of the others, by weight, in the same units
  int weight_one;               // [1 / weight_units]
  int sharing;                  // weights of the pairs that share it in the next pass
  uint backing;                 // that they give it
};

Pushes pushes_on(uint contact, float inverse_mass) {
  Pushes all = Pushes(ivec3(0), ivec3(0), ivec3(0), ivec3(0), 0, 0, 0u);
  while (contact != 0u) {
    --contact;
    uvec2 link = FETCH_UVEC2(contact_links, contact);
    vec4 push = FETCH(contact_pushes, 2u * (contact / 4u)), impulse = FETCH(contact_pushes, 2u * (contact / 4u) + 1u);
    float weight = uintBitsToFloat(link.y), mobility = weight * inverse_mass;
    int weight_here = weight_in_units(weight);
    bool one = abs(push.w) >= pushes_one && push.w * mobility > 0.0;
    uint backing = one ? uint(abs(push.w) - pushes_one) : 0u;
    float factor = one ? weight : push.w == pushes_both ? mobility : 0.0;
    ivec3 pushed = in_units(factor * push.xyz), changed = in_units(factor * impulse.xyz);
    all.push += one ? ivec3(0) : pushed;
    all.impulse += one ? ivec3(0) : changed;
    all.push_one += one ? pushed : ivec3(0);
    all.impulse_one += one ? changed : ivec3(0);
    all.weight_one += one ? weight_here : 0;
    all.sharing += impulse.w == 0.0 ? 0 : weight_here;
    all.backing = max(all.backing, max(backing, 1u) - 1u);
    contact = link.x;
  }
  return all;
}

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].touched) return;
  int i = int(FETCH(vertex_contacts, 2u * gl_GlobalInvocationID.x).y);
  vec4 x = position[i];
  vec3 v = velocity[i].xyz;
  Pushes all = pushes_on(FETCH(vertex_contacts, 2 * i).x, x.w);
  x.xyz += vec3(all.push) / units_of_length();
  v += vec3(all.impulse) / units_of_speed();
  if (recount != 0) at_vertex[i].sharing = uint(max(1, all.sharing));  // 0 would say that no pair touches it
  float weight = float(all.weight_one) / weight_units;
  if (weight > 0.0) {
    x.xyz += vec3(all.push_one) / (units_of_length() * weight);
    v += vec3(all.impulse_one) / (units_of_speed() * weight);
  }
  position[i].xyz = x.xyz;
  velocity[i].xyz = v;
  if (solid_friction == 1) borne[i] = Borne(vec4(0.0), vec4(0.0));
  uint backing = max(at_vertex[i].backing, all.backing);
  if (x.w > 0.0) {
    int met = stop_at_solids(i);
    if (met == 2 || (met == 1 && backing > 0u)) backing = most_backing;
    if (solid_friction == 3) rub_on_solid(i);
  }
  at_vertex[i].backing = backing;
}
