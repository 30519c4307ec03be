// The patches of implicit Euler's coarse level (server/sim/coarse_level.h), and sums over them. A work group has a slot
// for each patch of which it has vertices: there it writes its part of the patch's sum.
READ_UINT(patch_lists, unit_patch_lists);

// Where each list begins. patch_of: for each vertex its patch. group_slots: for each work group its first slot.
// slot_members: for each slot its first entry in members, which has lanes. patch_slots: for each patch its first entry
// in slots, which has slots.
uniform int patch_of, group_slots, slot_members, members, patch_slots, slots;
uniform int patch_count;
int patch_list(int list, int at) { return int(FETCH_UINT(patch_lists, list + at)); }
