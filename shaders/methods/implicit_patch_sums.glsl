// Sums over the vertices of each patch, by a kernel with one thread per vertex.
#include "implicit_patches.glsl"
// For each slot those of products, then of the vectors' parts in each mode.
layout(std430, binding = slot_patch_sums) writeonly buffer PatchSums { vec4 patch_sums[]; };
shared vec4 products_of_lanes[GROUP_SIZE];
shared vec3 vectors_of_lanes[GROUP_SIZE];
shared vec2 shares_of_lanes[GROUP_SIZE];

/// Writes the sums of a vertex's products and of its vector over each patch. To be called by all threads.
void write_patch_sums(vec4 products, vec3 vector) {
  int lane = int(gl_LocalInvocationID.x), group = int(gl_WorkGroupID.x), i = int(gl_GlobalInvocationID.x);
  products_of_lanes[lane] = products;
  vectors_of_lanes[lane] = vector;
  shares_of_lanes[lane] = i < vertex_count ? patch_shares(i) : vec2(0.0);
  barrier();
  int slot = patch_list(group_slots, group) + lane;
  if (slot >= patch_list(group_slots, group + 1)) return;
  products = vec4(0.0);
  vec3 sum = vec3(0.0), first = vec3(0.0), second = vec3(0.0);
  int end = patch_list(slot_members, slot + 1);
  for (int k = patch_list(slot_members, slot); k < end; ++k) {
    int member = patch_list(members, k);
    vec3 of_member = vectors_of_lanes[member];
    vec2 share = shares_of_lanes[member];
    products += products_of_lanes[member];
    sum += of_member;
    first += share.x * of_member;
    second += share.y * of_member;
  }
  int at = (1 + PATCH_MODES) * slot;
  patch_sums[at] = products;
  patch_sums[at + 1] = vec4(sum, 0.0);
  patch_sums[at + 2] = vec4(first, 0.0);
  patch_sums[at + 3] = vec4(second, 0.0);
}
