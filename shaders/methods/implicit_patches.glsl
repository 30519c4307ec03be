// The patches of implicit Euler's coarse level (server/sim/coarse_level.h), and sums over them. A work group has a slot
// for each patch of which it has vertices: there it writes its part of the patch's sum.
READ_UINT(patch_lists, unit_patch_lists);

// PATCH_OF: for each vertex its patch. GROUP_SLOTS: for each work group its first slot. SLOT_MEMBERS: for each slot its
// first entry in MEMBERS, which has lanes. PATCH_SLOTS: for each patch its first entry in SLOTS, which has slots.
int patch_list(int section, int at) { return int(FETCH_UINT(patch_lists, section + at)); }
