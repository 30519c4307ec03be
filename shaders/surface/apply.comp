// Contact, 3 of 3: the pushes on each vertex, in place.
#include "surface.glsl"
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_contact_sums) buffer Sums { int sums[]; };
// 1: from now on only those pairs share a vertex that pushed it in this pass. In the first passes too many others may
// begin to.
uniform int recount;

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
}
