// Sums over the vertices of each patch, by a kernel with one thread per vertex.
#include "implicit_patches.glsl"
layout(std430, binding = slot_patch_sums) writeonly buffer PatchSums { vec4 patch_sums[]; };  // two per slot
shared vec4 products_of_lanes[GROUP_SIZE];
shared vec3 vectors_of_lanes[GROUP_SIZE];

/// Writes the sums of a vertex's products and vector over each patch. To be called by all threads.
void write_patch_sums(vec4 products, vec3 vector) {
  int lane = int(gl_LocalInvocationID.x), group = int(gl_WorkGroupID.x);
  products_of_lanes[lane] = products;
  vectors_of_lanes[lane] = vector;
  barrier();
  int slot = patch_list(group_slots, group) + lane;
  if (slot >= patch_list(group_slots, group + 1)) return;
  products = vec4(0.0);
  vector = vec3(0.0);
  int end = patch_list(slot_members, slot + 1);
  for (int k = patch_list(slot_members, slot); k < end; ++k) {
    int member = patch_list(members, k);
    products += products_of_lanes[member];
    vector += vectors_of_lanes[member];
  }
  patch_sums[2 * slot] = products;
  patch_sums[2 * slot + 1] = vec4(vector, 0.0);
}
