// Contact, 3 of 3: the pushes on each vertex, in place.
#include "surface.glsl"
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_next_velocity) buffer Velocity { vec4 velocity[]; };
layout(std430, binding = slot_contact_sums) buffer Sums { int sums[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x), first = 8 * i;
  if (i >= vertex_count || sums[first + 3] == 0) return;
  position[i].xyz += vec3(sums[first], sums[first + 1], sums[first + 2]) / units_of_length();
  velocity[i].xyz += vec3(sums[first + 4], sums[first + 5], sums[first + 6]) / units_of_speed();
  for (int k = 0; k < 3; ++k) sums[first + k] = sums[first + 4 + k] = 0;
}
