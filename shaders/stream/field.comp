// Frame, with a field: its value at each vertex in the scene's order, and the largest, from which the range follows.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
uniform int vertex_count;
#include "../elements/lists.glsl"
#include "field.glsl"

READ_VEC4(position, unit_position);
READ_VEC4(velocity, unit_velocity);
READ_UINT(place, unit_places);
uniform int shuffled;  // 1: vertices lie in memory at `place`
uniform float kept;    // share of the peak before that still counts

/// As shaders/diagnose.comp counts it.
float field_at(int i) {
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
#ifdef FIELD_STRAIN
  float most = 0.0;
#each Law
  for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
    LawEntry entry = entry_of_Law(at.first);
    LawEdges dx;
    for (int k = 0; k < Law_CORNERS - 1; ++k) dx.d[k] = x.xyz - FETCH(position, entry.others[k]).xyz;
    most = max(most, element_strain(entry.law, dx));
  }
#end
  return most;
#elif defined(FIELD_SPEED)
  return length(v.xyz);
#elif defined(FIELD_CONTACT)
  return x.w > 0.0 && v.w > 0.0 ? 1.0 : 0.0;  // v.w of a pinned vertex is its motion's index
#else
#error this field has no branch in field.comp
#endif
}

shared float largest[GROUP_SIZE];

void main() {
  int i = int(gl_GlobalInvocationID.x), lane = int(gl_LocalInvocationID.x);
  float value = 0.0;
  if (i < vertex_count) {
    value = field_at(shuffled != 0 ? int(FETCH_UINT(place, i)) : i);
    // A cloth that blows up: beyond any range, but no number that spoils it.
    if (isnan(value) || value > largest_value) value = largest_value;
    values[i] = value;
  }
  largest[lane] = i == 0 ? max(value, kept * uintBitsToFloat(peak[1 - turn])) : value;
  barrier();
  for (int half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
    if (lane < half_size) largest[lane] = max(largest[lane], largest[lane + half_size]);
    barrier();
  }
  // Floats that are not negative have the order of their bits.
  if (lane == 0) atomicMax(peak[turn], floatBitsToUint(largest[0]));
}
