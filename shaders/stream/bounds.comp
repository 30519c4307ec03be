// Frame, 1 of 2: the box that holds every vertex. Vertices that are not finite are left out.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "bounds.glsl"

READ_VEC4(position, unit_position);
uniform int vertex_count;
shared vec3 low[GROUP_SIZE];
shared vec3 high[GROUP_SIZE];

void main() {
  int i = int(gl_GlobalInvocationID.x), lane = int(gl_LocalInvocationID.x);
  const float huge = 3e38;
  low[lane] = vec3(huge);
  high[lane] = vec3(-huge);
  if (i < vertex_count) {
    vec3 x = FETCH(position, i).xyz;
    float size = dot(x, x);
    if (!isnan(size) && !isinf(size)) low[lane] = high[lane] = x;
  }
  barrier();
  for (int half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
    if (lane < half_size) {
      low[lane] = min(low[lane], low[lane + half_size]);
      high[lane] = max(high[lane], high[lane + half_size]);
    }
    barrier();
  }
  if (lane < 3) {
    atomicMin(box_low[lane], ordered(low[0][lane]));
    atomicMax(box_high[lane], ordered(high[0][lane]));
  }
}
