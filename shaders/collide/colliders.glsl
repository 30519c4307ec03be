// Stops a vertex's step at the surfaces of solids, by the law of each kind (elements/solid.glsl). Solids are met kind
// after kind, within a kind in the scene's order. A kernel is compiled for the solids of its scene: EACH_SOLID(meet)
// calls `meet(kind, moves, first, end)` for the rows of each run of them that are of one kind and all move or all rest.
#include "../elements/contact.glsl"
#include "../elements/solid.glsl"
#include "../rarely.glsl"

#if SOLID_ROWS > 0
// The rows of each solid before any motion: point [m], radius + margin [m]; direction, extent.x [m]; friction,
// restitution, motion, extent.y; for a kind with axes also second, extent.z.
uniform vec4 solids[SOLID_ROWS];
#endif

// The margin in `solids` is the least that any cloth keeps. Where others keep more, CLOTHS_APART is defined as the
// number of cloths, and a kernel says whose path it is with `meet_as` before it asks for solids.
#ifdef CLOTHS_APART
uniform vec2 cloths_apart[CLOTHS_APART];  // the first vertex of each cloth; how much more it keeps [m]
float farther = 0.0;                      // the share of this vertex's cloth [m]

void meet_as(int vertex) {
  for (int cloth = 0; cloth < CLOTHS_APART; ++cloth)
    if (vertex >= int(cloths_apart[cloth].x)) farther = cloths_apart[cloth].y;
}

/// With surfaces that touch, cloths differ only in how far they keep from boxes that move.
float own_reach(int kind, bool moves) {
#ifdef APART_FROM_MOVING_BOXES
  return kind == solid_box && moves ? farther : 0.0;
#else
  return farther;
#endif
}
#else
void meet_as(int vertex) {}
float own_reach(int kind, bool moves) { return 0.0; }
#endif

// The surface met last: its unit normal, its velocity [m/s] at the contact, friction and restitution.
vec3 met_normal, met_velocity;
vec2 met_surface;
/// How deep within that solid the path began [m]; 0: outside.
float met_depth;
/// Displacement [m] that friction takes from the path. The caller applies it: not all callers use the velocity given.
vec3 met_braking;

#include "../methods/step_time.glsl"
#ifdef SOLIDS_IN_PIECES
float piece_begin = 0.0, piece_end = 1.0;  // of the step, which part the path is
float path_time() { return whole_dt * (piece_end - piece_begin); }
#else
float path_time() { return whole_dt; }
#endif

#ifdef SECOND_VELOCITY
vec3 second_velocity;  // a second velocity of the vertex: contacts change it, too
#endif

/// `surface`: friction, restitution, motion.
void meet_surface(vec3 surface, vec3 normal, vec3 from, vec3 x, inout vec3 v) {
  int motion = int(surface.z);
  vec3 moving = vec3(0.0);
  RARELY(motion >= 0) moving = velocity_at(motion, END_ROW, x);
  met_normal = normal;
  met_velocity = moving;
  met_surface = surface.xy;
  vec3 slid = x - met_braking - from - path_time() * moving;
  met_braking += contact_braking(slid, v - moving, normal, surface.x, surface.y);
  v = moving + contact_velocity(v - moving, normal, surface.x, surface.y);
#ifdef SECOND_VELOCITY
  second_velocity = moving + contact_velocity(second_velocity - moving, normal, surface.x, surface.y);
#endif
}

#if SOLID_ROWS > 0
/// The solid whose first row is given, thicker by `reach` [m], before any motion.
Solid solid_at(int kind, int first, float reach) {
  vec4 place = solids[first], direction = solids[first + 1];
  Solid solid = Solid(place.xyz, direction.xyz, place.w + reach, vec3(0.0), vec3(0.0));
  if (solid_has_axes(kind)) {
    vec4 second = solids[first + 3];
    solid.second = second.xyz;
    solid.extent = vec3(direction.w, solids[first + 2].w, second.w);
  }
  return solid;
}

/// Where its motion takes a solid, at a row of the step.
Solid moved_to(int kind, int motion, int row, Solid solid) {
  solid.point = placed(motion, row, solid.point);
  solid.direction = turned(motion, row, solid.direction);
  if (solid_has_axes(kind)) solid.second = turned(motion, row, solid.second);
  return solid;
}

/// Between two places of a solid, at a share of the way. Where it turns by half a turn there is no direction in the
/// middle: it has that of the end there.
Solid between(Solid before, Solid after, float share) {
  Solid solid = after;
  solid.point = mix(before.point, after.point, share);
  vec3 direction = mix(before.direction, after.direction, share);
  float length_squared = dot(direction, direction);
  if (length_squared > 0.0) solid.direction = direction * inversesqrt(length_squared);
  vec3 second = mix(before.second, after.second, share);
  vec3 across = second - solid.direction * dot(second, solid.direction);
  float squared = dot(across, across);
  if (squared > 0.0) solid.second = across * inversesqrt(squared);
  return solid;
}

/// Where a solid, thicker by `reach` [m], is when the path begins and when it ends. `first`: its first row.
void place_solid(int kind, bool moves, int first, float reach, out Solid before, out Solid after) {
  before = after = solid_at(kind, first, reach + own_reach(kind, moves));
  if (moves) {
    int motion = int(solids[first + 2].z);
    after = moved_to(kind, motion, END_ROW, before);
    before = moved_to(kind, motion, 0, before);
#ifdef SOLIDS_IN_PIECES
    Solid start = before, end = after;
    before = between(start, end, piece_begin);
    after = between(start, end, piece_end);
#endif
  }
}

/// Stops the path from -> x at a solid, thicker by `reach` [m], and changes the end velocity v. `first`: its first row.
/// Returns the number of contacts, 0 or 1.
int meet_solid(int kind, bool moves, int first, vec3 from, inout vec3 x, inout vec3 v, float reach) {
  vec3 surface = solids[first + 2].xyz;
  int met = 0;
  Solid before, after;
  place_solid(kind, moves, first, reach, before, after);
  RARELY(solid_near(kind, before, after, from, x)) {
    vec3 stopped, normal;
    if (solid_contact(kind, before, after, from, x, stopped, normal)) {
      x = stopped;
      met_depth = max(solid_depth(kind, before, from), 0.0);
      meet_surface(surface, normal, from, x, v);
      met = 1;
    }
  }
  return met;
}

/// The same at a run of solids of one kind: those from row `first` to row `end`. Software OpenGL runs all the code of
/// an `if` for each of them; so of many at rest it looks, by a cheap test, for the next one that the path can meet.
int meet_run(int kind, bool moves, int first, int end, vec3 from, inout vec3 x, inout vec3 v, float reach) {
  const int few = 4;
  int rows = solid_rows(kind), met = 0;
  bool many = !moves && end - first > few * rows;
  float near = reach + own_reach(kind, moves);
  for (int row = first; row < end; row += rows) {
    if (many) {
      int next = end;
      for (int other = end - rows; other >= first; other -= rows)
        if (other >= row && solid_within(kind, solid_at(kind, other, near), from, distance(from, x))) next = other;
      row = next;
    }
    if (row < end) met += meet_solid(kind, moves, row, from, x, v, reach);
  }
  return met;
}
#endif

/// Depth of x below the surface of the solid at rest in which it is deepest, thicker by `reach` [m]; less than 0
/// outside of all.
float depth_in_solids_at_rest(vec3 x, float reach) {
  float depth = -1e30;
#if SOLID_ROWS > 0
#define DEEPEST(kind, moves, first, end)                       \
  for (int row = first; !moves && row < end; row += solid_rows(kind)) \
    depth = max(depth, solid_depth(kind, solid_at(kind, row, reach + own_reach(kind, false)), x));
  EACH_SOLID(DEEPEST)
#endif
  return depth;
}

/// The same of the solids that move, where the path ends.
float depth_in_moving_solids(vec3 x, float reach) {
  float depth = -1e30;
#if SOLID_ROWS > 0
  Solid before, after;
#define DEEPEST_MOVING(kind, moves, first, end)                        \
  for (int row = first; moves && row < end; row += solid_rows(kind)) { \
    place_solid(kind, true, row, reach, before, after);                \
    depth = max(depth, solid_depth(kind, after, x));                   \
  }
  EACH_SOLID(DEEPEST_MOVING)
#endif
  return depth;
}

/// Stops the step from -> x, with end velocity v, at the solids, thicker by `reach` [m]. Returns the number of solids
/// met.
int resolve_colliders(vec3 from, inout vec3 x, inout vec3 v, float reach) {
  int contacts = 0;
  met_braking = vec3(0.0);
#if SOLID_ROWS > 0
#define MEET(kind, moves, first, end) contacts += meet_run(kind, moves, first, end, from, x, v, reach);
  EACH_SOLID(MEET)
#endif
  return contacts;
}
