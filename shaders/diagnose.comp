// Energies, largest strain and speed, contacts, and whether every value is finite. Each work group writes a partial
// result; the host sums them in double precision and in order, so that the outcome does not depend on the order of
// threads.
layout(local_size_x = GROUP_SIZE) in;
#include "access.glsl"
uniform int vertex_count;
#include "elements/lists.glsl"

READ_VEC4(position, unit_position);
READ_VEC4(velocity, unit_velocity);
uniform vec4 gravity;

struct Partial {
  vec4 sums;     // kinetic, elastic, gravitational energy [J], vertices in contact
  vec4 largest;  // strain, speed squared, 1 if something is not finite, unused
  vec4 work;     // pull at moving pins [N], pull and weight of touching vertices [N], their mass [kg], unused
};
layout(std430, binding = slot_partials) writeonly buffer Partials { Partial partials[]; };
shared vec4 sums[GROUP_SIZE];
shared vec4 largest[GROUP_SIZE];
shared vec4 work[GROUP_SIZE];

void main() {
  int i = int(gl_GlobalInvocationID.x);
  int lane = int(gl_LocalInvocationID.x);
  vec4 sum = vec4(0.0), most = vec4(0.0), pull = vec4(0.0);
  if (i < vertex_count) {
    vec4 x = FETCH(position, i), v = FETCH(velocity, i);
    bool moving_pin = x.w == 0.0 && v.w >= 0.0, touching = x.w > 0.0 && v.w > 0.0;
    vec3 force = vec3(0.0);
#each Law
    for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
      LawEntry entry = entry_of_Law(at.first);
      LawEdges dx, dv;
      for (int k = 0; k < Law_CORNERS - 1; ++k) {
        int j = entry.others[k];
        dx.d[k] = x.xyz - FETCH(position, j).xyz;
        dv.d[k] = v.xyz - FETCH(velocity, j).xyz;
      }
      sum.y += element_energy(entry.law, dx) / float(Law_CORNERS);  // the other corners count the rest
      most.x = max(most.x, element_strain(entry.law, dx));
      if (moving_pin || touching) force += element_force(entry.law, dx, dv);
    }
#end
    float speed_squared = dot(v.xyz, v.xyz);
    if (x.w > 0.0) {
      sum.x = 0.5 / x.w * speed_squared;
      sum.z = -dot(gravity.xyz, x.xyz) / x.w;
      sum.w = v.w > 0.0 ? 1.0 : 0.0;
    }
    if (moving_pin) pull.x = length(force);
    if (touching) pull.yz = vec2(length(force) + length(gravity.xyz) / x.w, 1.0 / x.w);
    most.y = speed_squared;
    float all_values = dot(x.xyz, x.xyz) + speed_squared;
    most.z = isnan(all_values) || isinf(all_values) ? 1.0 : 0.0;
  }
  sums[lane] = sum;
  largest[lane] = most;
  work[lane] = pull;
  barrier();
  for (int half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
    if (lane < half_size) {
      sums[lane] += sums[lane + half_size];
      work[lane] += work[lane + half_size];
      largest[lane] = max(largest[lane], largest[lane + half_size]);
    }
    barrier();
  }
  if (lane == 0) partials[gl_WorkGroupID.x] = Partial(sums[0], largest[0], work[0]);
}
