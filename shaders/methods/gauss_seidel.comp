// PBD, XPBD and VBD. A step begins with a guess of where each vertex will be. Sweeps over the elements (VBD: vertices),
// colour after colour, improve the guess; a pass of contacts follows each sweep. The last guess is the new state. Items
// of one colour do not touch each other, so the outcome depends on no order of threads (server/model/colouring.h).
// There are two forms, for small cloths and for large: with ONE_GROUP the whole step runs in one work group, with
// barriers; otherwise each PHASE, and each colour, is a dispatch.
#include "gather.glsl"
#include "step_end.glsl"
#include "../collide/colliders.glsl"
#include "deviation.glsl"

/// True if velocity v is an impact on the surface met last: a speed that gravity gives in two steps is no impact.
bool hits(vec3 v) { return dot(met_velocity - v, met_normal) > 2.0 * dt * length(gravity.xyz); }

#ifdef BY_VERTEX
#include "vertex_descent.glsl"
#else
#include "element_projection.glsl"
#endif
#include "sweep_contacts.glsl"

void begin(int i) {
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 there, moving;
  if (x.w > 0.0) {
    set_deviation(i, vec4(remainder(i) + first_deviation(i, x, v.xyz), v.w));
  } else {
    follow_motion(i, x.xyz, v.w, END_ROW, there, moving);
    set_deviation(i, vec4((there - x.xyz) - free_displacement(v.xyz), 0.0));
  }
}

/// The state at the step's end; stores what rounding takes from it.
void advance(int i, vec3 x, vec3 v, vec3 d, out vec3 x_next, out vec3 v_next) {
  precise vec3 moved = free_displacement(v) + d;
  precise vec3 gained =
      mobility * (remainders[i].velocity.xyz + dt * (gravity.xyz - gravity.w * v)) + (d - remainder(i)) / dt;
  precise vec3 there = x + moved, then = v + gained;
  precise vec3 rounded_move = there - x, rounded_gain = then - v;
  remainders[i].position.xyz = moved - rounded_move;
  remainders[i].velocity.xyz = gained - rounded_gain;
  x_next = there;
  v_next = then;
}

/// Velocity of a vertex after an impact on a surface: it leaves with the restitution's share of its speed. What moved
/// it out of a solid in which it began the step is no velocity: it may have been put there.
vec3 rebound(vec3 x, vec3 v_start, vec3 v) {
  vec3 free = x + free_displacement(v_start), unused = v_start;
  RARELY(resolve_colliders(x, free, unused, 0.0) > 0) {
    v -= met_normal * clamp(dot(v - met_velocity, met_normal), 0.0, met_depth / dt);
    if (met_surface.y > 0.0 && hits(v_start))
      v += met_normal * (met_surface.y * dot(met_velocity - v_start, met_normal) - dot(v - met_velocity, met_normal));
  }
  return v;
}

/// Waits until the whole work group is here and its writes are visible.
void wait() {
  groupMemoryBarrier();
  barrier();
}

#ifdef BALANCED
// Sweeps that move one vertex after another give a cloth that nothing holds a false momentum, as large as their error.
// Springs and self-collision only pass momentum on: the false part is taken from all vertices of the cloth alike.
uniform ivec2 free_vertices[CLOTH_COUNT];  // first, end; empty for a cloth with pins
// SLICE_SIZE sums for each cloth: xyz [kg m], w [kg]
layout(std430, binding = slot_lacking) coherent buffer Lacking { vec4 lacking[]; };

/// Called by one work group. Which vertices make a sum, and in what order, does not depend on its number of threads:
/// both forms of the kernel come to the same bits.
void balance(int cloth) {
  int first_sum = cloth * SLICE_SIZE, lane = int(gl_LocalInvocationID.x), end = free_vertices[cloth].y;
  for (int k = lane; k < SLICE_SIZE; k += GROUP_SIZE) {
    vec4 sum = vec4(0.0);
    for (int i = free_vertices[cloth].x + k; i < end; i += SLICE_SIZE) {
#ifdef WIND
      float mass = 1.0 / FETCH(position, i).w + mobility * remainders[i].position.w;
      sum += mass * vec4(targets[i].xyz - deviation(i).xyz, 1.0);
#else
      sum += vec4(targets[i].xyz - deviation(i).xyz, 1.0) / FETCH(position, i).w;
#endif
    }
    lacking[first_sum + k] = sum;
  }
  wait();
  vec4 sum = vec4(0.0);
  for (int k = 0; k < SLICE_SIZE; ++k) sum += lacking[first_sum + k];
  for (int i = free_vertices[cloth].x + lane; i < end; i += GROUP_SIZE) {
    vec4 d = deviation(i);
    set_deviation(i, vec4(d.xyz + sum.xyz / sum.w, d.w));
  }
}
#endif

void finish(int i) {
  vec4 x = FETCH(position, i), v = FETCH(velocity, i), d = deviation(i);
  vec3 x_next, v_next;
  float tag = v.w;
  if (x.w > 0.0) {
    advance(i, x.xyz, v.xyz, d.xyz, x_next, v_next);
#if SOLID_ROWS > 0
    meet_as(i);
    v_next = rebound(x.xyz, v.xyz, v_next);
#endif
    tag = d.w;
  } else {
    follow_motion(i, x.xyz, tag, END_ROW, x_next, v_next);
  }
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}

#ifdef ONE_GROUP
uniform int colour_first[COLOUR_ROOM];  // item, of each colour and behind the last
uniform ivec2 colours_of[VISIT_ROOM];  // for each visit of EACH_VISIT its first colour and the one behind its last

#define EACH(item, first, end) int item = first + int(gl_LocalInvocationID.x); item < end; item += GROUP_SIZE
// EACH_VISIT(sweep) calls `sweep(visit, k)` for each function that visits items, and its number k.
#define SWEEP(visit, k)                                                                       \
  for (int colour = colours_of[k].x; colour < colours_of[k].y; ++colour) {                    \
    for (EACH(item, colour_first[colour], colour_first[colour + 1])) visit(item);             \
    wait();                                                                                   \
  }

void main() {
  for (EACH(i, 0, vertex_count)) begin(i);
  wait();
  for (sweep = 0; sweep <= last_sweep; ++sweep) {
    EACH_VISIT(SWEEP)
#ifdef CONTACTS
    copy_written = DEVIATIONS - 1 - copy_read;
    for (EACH(i, 0, vertex_count)) meet(i);
    copy_read = copy_written;
    wait();
#endif
  }
#ifdef BALANCED
  copy_written = copy_read;
  for (int cloth = 0; cloth < CLOTH_COUNT; ++cloth) balance(cloth);
  wait();
#endif
  for (EACH(i, 0, vertex_count)) finish(i);
}
#elif defined(EACH_CLOTH)
void main() { balance(int(gl_WorkGroupID.x)); }
#else
uniform int first, end;  // items

void main() {
  int item = first + int(gl_GlobalInvocationID.x);
  if (item < end) PHASE(item);
}
#endif
