// Stops a vertex's step at the surfaces of solids, by the law of each kind (elements/solid.glsl). Solids are met kind
// after kind, within a kind in the scene's order. A kernel is compiled for the kinds that its scene has:
// EACH_SOLID(meet) calls `meet(kind, first, end)` for each of them; solids first to end - 1 are of that kind.
#include "../elements/contact.glsl"
#include "../elements/solid.glsl"
#include "../rarely.glsl"

#if SOLID_COUNT > 0
// For each solid: point before any motion [m], radius + margin [m]; direction before any motion; friction, restitution,
// motion.
uniform vec4 solids[3 * SOLID_COUNT];
#endif

// The surface met last: its unit normal, its velocity [m/s] at the contact, friction and restitution.
vec3 met_normal, met_velocity;
vec2 met_surface;
/// Displacement [m] that friction takes from the step. The caller applies it: not all callers use the velocity given.
vec3 met_braking;

#ifdef SECOND_VELOCITY
vec3 second_velocity;  // a second velocity of the vertex: contacts change it, too
#endif

void meet_surface(int motion, vec3 surface, vec3 normal, vec3 from, vec3 x, inout vec3 v) {
  vec3 moving = vec3(0.0);
  RARELY(motion >= 0) moving = velocity_at(motion, END_ROW, x);
  met_normal = normal;
  met_velocity = moving;
  met_surface = surface.xy;
  met_braking += contact_braking(x - met_braking - from - dt * moving, v - moving, normal, surface.x, surface.y);
  v = moving + contact_velocity(v - moving, normal, surface.x, surface.y);
#ifdef SECOND_VELOCITY
  second_velocity = moving + contact_velocity(second_velocity - moving, normal, surface.x, surface.y);
#endif
}

#if SOLID_COUNT > 0
/// Solid i at a row of the step, thicker by `reach` [m].
Solid solid_at(int i, int motion, int row, float reach) {
  vec3 point = solids[3 * i].xyz, direction = solids[3 * i + 1].xyz;
  RARELY(motion >= 0) {
    point = placed(motion, row, point);
    direction = turned(motion, row, direction);
  }
  return Solid(point, direction, solids[3 * i].w + reach);
}

/// Stops the step from -> x at solid i, and changes the end velocity v. Returns true if they meet.
bool meet_solid(int kind, int i, vec3 from, inout vec3 x, inout vec3 v, float reach) {
  vec3 surface = solids[3 * i + 2].xyz;
  int motion = int(surface.z);
  Solid before = solid_at(i, motion, 0, reach), after = solid_at(i, motion, END_ROW, reach);
  bool met = false;
  RARELY(solid_near(kind, before, after, from, x)) {
    vec3 stopped, normal;
    if (solid_contact(kind, before, after, from, x, stopped, normal)) {
      x = stopped;
      meet_surface(motion, surface, normal, from, x, v);
      met = true;
    }
  }
  return met;
}
#endif

/// Stops the step from -> x, with end velocity v, at the solids, thicker by `reach` [m]. Returns the number of solids
/// met.
int resolve_colliders(vec3 from, inout vec3 x, inout vec3 v, float reach) {
  int contacts = 0;
  met_braking = vec3(0.0);
#if SOLID_COUNT > 0
#define MEET(kind, first, end) \
  for (int i = first; i < end; ++i) contacts += int(meet_solid(kind, i, from, x, v, reach));
  EACH_SOLID(MEET)
#endif
  return contacts;
}
