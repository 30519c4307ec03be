// Contact with solids as a term of the step's problem: an energy of each vertex's distance from each solid, as pairs of
// surfaces have it. Solids go the same share of the step as the cloth. Needs motions.glsl.
#define SOLIDS_IN_PIECES
#include "../collide/colliders.glsl"
#include "../elements/surface.glsl"
#include "../elements/surface_energy.glsl"
uniform float margin;                    // from which distance on solids press [m]
uniform float solid_stiffness_per_mass;  // [1/s^2]
uniform float heaviest;                  // mass of a free vertex in the scene [kg]
uniform float gone;                      // share of the step that solids have gone

/// Stiffness of a vertex at a solid [N/m], of the mass that it may have to bear: but of no more than a hundred times
/// its own, as floats would leave nothing of its inertia.
float solid_stiffness(float inverse_mass) {
  return solid_stiffness_per_mass * min(heaviest, 100.0 / inverse_mass);
}

#if SOLID_ROWS > 0
/// Where a solid is at the iterate, and a share of the rest of the step later.
void place_at_iterate(int kind, bool moves, int first, float share, out Solid now, out Solid later) {
  piece_begin = gone;
  piece_end = gone + (1.0 - gone) * share;
  place_solid(kind, moves, first, 0.0, now, later);
}

/// A vertex that begins the step within a solid is not stopped by it: the step's end takes it out, without speed.
bool begins_within(int kind, bool moves, int first, vec3 start) {
  piece_begin = piece_end = 0.0;
  Solid there, same;
  place_solid(kind, moves, first, 0.0, there, same);
  float rounding = 5e-7 * max(abs(start.x), max(abs(start.y), abs(start.z)));
  return margin - solid_depth(kind, there, start) <= max(0.001 * margin, rounding);
}

/// Velocity of a solid where a vertex touches it [m/s].
vec3 solid_velocity(int first, vec3 x) {
  int motion = int(solids[first + 2].z);
  vec3 moving = vec3(0.0);
  RARELY(motion >= 0) moving = velocity_at(motion, END_ROW, x);
  return moving;
}
#endif
