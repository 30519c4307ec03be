// Provot 1995, section 4: after a step of any method, springs longer than they may be are shortened by moving their
// ends, each by its inverse mass, until none is left; the velocities take the same correction. All springs are looked
// at at once, from the positions of the sweep before (projected Jacobi), so the outcome depends on no order. They pull
// along the direction they had at the step's start, as in SHAKE (Ryckaert, Ciccotti & Berendsen 1977), which keeps the
// angular momentum; where a spring has turned by more than 60 degrees in the step, along the one it has now. By how
// much a limit has pulled is kept and begins the next step (warm starting): otherwise the weight of a hanging cloth
// would have to find its way up to the pins anew in every step.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "../rarely.glsl"
uniform int vertex_count;
#include "../elements/lists.glsl"

READ_VEC4(position, unit_position);              // w: inverse mass [1/kg], 0 if pinned
READ_VEC4(rest_position, unit_rest_position);    // w: the cloth
READ_VEC4(start_position, unit_start_position);  // at the step's start
/// Of each entry of the list of springs, its own vertex's alone: impulse times dt, 0 or more [kg m].
layout(std430, binding = slot_pulls) buffer Pulls { float pulls[]; };
/// What the pulls have given to each vertex since the step ended, times dt [kg m]. The velocities follow from it: a
/// difference of positions would give them what float32 took from those, and with that momentum.
layout(std430, binding = slot_given) buffer Given { vec4 given[]; };
uniform float limit[CLOTH_COUNT];  // largest strain of each cloth's springs; negative: none

/// Springs are pulled to this share of the limit below it, so that the sweeps can end with none above.
const float margin = 0.02;

vec3 unit(vec3 d) {
  float squared = dot(d, d);
  return squared > 0.0 ? d * inversesqrt(squared) : vec3(0.0);
}

/// The way in which a spring that is now along d, and was along d_start, pulls its first end away from its second; and
/// by how much it grows if the ends are moved apart that way by 1.
vec3 pull_direction(vec3 d, vec3 d_start, out float growth) {
  vec3 n = unit(d), n_start = unit(d_start);
  growth = dot(n, n_start);
  if (growth > 0.5) return n_start;
  growth = 1.0;
  return n;
}
