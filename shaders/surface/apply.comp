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
  meet_as(i);
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

/// What the pair of a contact does to the vertex.
struct Contact {
  uint next;     // contact of the vertex, by number + 1; 0: none
  vec3 push;     // [m]
  vec3 impulse;  // [m/s]
  bool one;      // the other part gives no way
  uint weight;   // how near the contact is to the vertex [1 / weight_units]
  bool shares;   // the pair shares the vertex in the next pass
  uint backing;  // that the pair gives the vertex
};

Contact contact_at(uint contact, float inverse_mass) {
  uvec2 link = FETCH_UVEC2(contact_links, contact);
  vec4 push = FETCH(contact_pushes, 2u * (contact / 4u)), impulse = FETCH(contact_pushes, 2u * (contact / 4u) + 1u);
  float weight = uintBitsToFloat(link.y), mobility = weight * inverse_mass;
  bool one = abs(push.w) >= pushes_one && push.w * mobility > 0.0;
  float factor = one ? sign(weight) : push.w == pushes_both ? mobility : 0.0;
  uint backing = one ? max(uint(abs(push.w) - pushes_one), 1u) - 1u : 0u;
  return Contact(link.x, factor * push.xyz, factor * impulse.xyz, one, weight_in_units(weight), impulse.w != 0.0,
                 backing);
}

float largest_of(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

/// What the contacts of a vertex are, before their pushes are summed.
struct Contacts {
  uint count;
  uint weight_one;  // of those whose other part gives no way [1 / weight_units]
  uint sharing;     // of the pairs that share the vertex in the next pass, the same
  uint backing;     // that they give it
  float push;       // the largest component of any [m]
  float impulse;    // the same [m/s]
};

Contacts contacts_of(uint contact, float inverse_mass) {
  Contacts all = Contacts(0u, 0u, 0u, 0u, 0.0, 0.0);
  while (contact != 0u) {
    Contact c = contact_at(contact - 1u, inverse_mass);
    all = Contacts(all.count + 1u, all.weight_one + (c.one ? c.weight : 0u), all.sharing + (c.shares ? c.weight : 0u),
                   max(all.backing, c.backing), max(all.push, largest_of(c.push)),
                   max(all.impulse, largest_of(c.impulse)));
    contact = c.next;
  }
  return all;
}

/// How many units make 1, in a sum of `count` numbers of at most `largest`: then no sum is beyond 2^30 and what
/// rounding adds, half a unit for each number, whatever the numbers are.
float units_for(float largest, uint count) { return 1073741824.0 / (max(largest, 1e-20) * float(max(count, 1u))); }

/// Sums over the contacts of a vertex, of integers: so their order does not matter. A part that meets one which gives
/// no way must do all of it: a vertex that several such pairs push takes their mean, weighted by how near their contact
/// is to it.
void add_pushes(uint contact, float inverse_mass, Contacts all, inout vec3 x, inout vec3 v) {
  float units_of_push = units_for(all.push, all.count), units_of_impulse = units_for(all.impulse, all.count);
  ivec3 pushed = ivec3(0), changed = ivec3(0);
  while (contact != 0u) {
    Contact c = contact_at(contact - 1u, inverse_mass);
    float share = c.one ? float(c.weight) / float(all.weight_one) : 1.0;
    pushed += ivec3(round(share * units_of_push * c.push));
    changed += ivec3(round(share * units_of_impulse * c.impulse));
    contact = c.next;
  }
  x += vec3(pushed) / units_of_push;
  v += vec3(changed) / units_of_impulse;
}

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].touched) return;
  int i = int(FETCH(vertex_contacts, 2u * gl_GlobalInvocationID.x).y);
  vec4 x = position[i];
  vec3 v = velocity[i].xyz;
  uint first = FETCH(vertex_contacts, 2 * i).x;
  Contacts all = contacts_of(first, x.w);
  add_pushes(first, x.w, all, x.xyz, v);
  if (recount != 0) at_vertex[i].sharing = max(1u, all.sharing);  // 0 would say that no pair touches it
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
