// The patches of implicit Euler's coarse level (server/sim/coarse_level.h), and sums over them. A work group has a slot
// for each patch of which it has vertices: there it writes its part of the patch's sum.
READ_UINT(patch_lists, unit_patch_lists);

// Where each list begins. patch_of: for each vertex its patch. group_slots: for each work group its first slot.
// slot_members: for each slot its first entry in members, which has lanes. patch_slots: for each patch its first entry
// in slots, which has slots. shares_in_patch: for each vertex its shares in its patch's modes but the first, which is 1
// for all. group_of: for each patch its group in the tree of patches; tree: for each group six numbers, those of
// implicit_step.comp's PatchGroup.
uniform int patch_of, group_slots, slot_members, members, patch_slots, slots, shares_in_patch, group_of, tree;
uniform int patch_count;
int patch_list(int list, int at) { return int(FETCH_UINT(patch_lists, list + at)); }

#define PATCH_MODES 3  // vectors of which a patch's motion is made
#define PATCH_UNKNOWNS 9

/// The vertex's shares in the second and third mode.
vec2 patch_shares(int i) {
  return vec2(uintBitsToFloat(FETCH_UINT(patch_lists, shares_in_patch + 2 * i)),
              uintBitsToFloat(FETCH_UINT(patch_lists, shares_in_patch + 2 * i + 1)));
}
