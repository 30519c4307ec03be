// Provot 1995, section 4: after a step of any method, springs beyond their limit (sheet.glsl: threads of triangles) are
// shortened by moving their ends, each by its inverse mass, until none is too long; the velocities take the same
// correction. All are handled at once, from the positions of the sweep before (projected Jacobi), so the outcome
// depends on no order. A spring pulls along its direction at the step's start, as in SHAKE (Ryckaert, Ciccotti &
// Berendsen 1977), which keeps the angular momentum; if it has turned by more than 60 degrees in the step, along its
// present direction. Each spring's pull is kept and begins the next step (warm starting): otherwise the weight of a
// hanging cloth would have to find its way up to the pins anew in every step.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "../rarely.glsl"
uniform int vertex_count;
#include "../elements/lists.glsl"

READ_VEC4(position, unit_position);  // w: inverse mass [1/kg], 0 if pinned
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
READ_VEC4(start_position, unit_start_position);  // at the step's start
/// For each entry of the list of springs, written by its own vertex alone: impulse times dt, 0 or more [kg m].
layout(std430, binding = slot_pulls) buffer Pulls { float pulls[]; };
/// Impulse of the pulls on each vertex since the step ended, times dt [kg m]. The velocities follow from it: a
/// difference of positions would carry their float32 rounding into the velocities, and so into the momentum.
layout(std430, binding = slot_given) buffer Given { vec4 given[]; };
uniform vec2 limit[CLOTH_COUNT];  // largest strain of each cloth, along warp and weft; negative: no limit

/// Springs are pulled to less than the limit by this share of it, so that the sweeps can end with none above the limit.
const float margin = 0.02;

vec3 unit(vec3 d) {
  float squared = dot(d, d);
  return squared > 0.0 ? d * inversesqrt(squared) : vec3(0.0);
}

/// Direction in which a spring pulls its first end away from its second; d, d_start: its direction now and at the
/// step's start. `growth`: how much it lengthens if its ends are moved apart that way by 1.
vec3 pull_direction(vec3 d, vec3 d_start, out float growth) {
  vec3 n = unit(d), n_start = unit(d_start);
  growth = dot(n, n_start);
  if (growth > 0.5) return n_start;
  growth = 1.0;
  return n;
}
