// The elements at each vertex: for each law a list of (element, corner), in slices of SLICE_SIZE vertices. The lists of
// a slice are padded to its longest one (sliced ELLPACK: Monakov et al. 2010), so that neighbouring threads read
// neighbouring entries. server/sim/element_lists.h makes the lists. Needs vertex_count. A kernel gathers with
//   #each Law
//     for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
//       LawEntry entry = entry_of_Law(at.first);
//       ...
//   #end
// server/gl/program.h repeats this for each law of which the scene has elements, and puts its name in place of Law.
#include "types.glsl"
#include "bending.glsl"
#include "constraint.glsl"
#include "membrane.glsl"
#include "shell.glsl"
#include "spring.glsl"

#ifndef SLICE_SIZE
#define SLICE_SIZE GROUP_SIZE
#endif
READ_UVEC4(elements, unit_elements);  // entries in each law's layout, a texel in a row of SLICE_SIZE
READ_UINT(element_slices, unit_element_slices);  // for each law [slices + 1]: the first row of each slice

struct EntryRange {
  int first, end;
};

/// First and end of the entries of vertex i in list number `list`.
EntryRange entry_range(int list, int i) {
  int slice = i / SLICE_SIZE, lane = i % SLICE_SIZE, slices = (vertex_count + SLICE_SIZE - 1) / SLICE_SIZE;
  int at = list * (slices + 1) + slice;
  return EntryRange(int(FETCH_UINT(element_slices, at)) * SLICE_SIZE + lane,
                    int(FETCH_UINT(element_slices, at + 1)) * SLICE_SIZE);
}

#each Law
/// An element as one of its corners sees it.
struct LawEntry {
  int others[Law_CORNERS - 1];  // the vertices at its other corners, in cyclic order
  Law law;
};

/// The entry whose first texel is number `at`: the other vertices, then the law's numbers. An entry of padding has the
/// vertex itself as its other corners, and zeros: it gives no force.
LawEntry entry_of_Law(int at) {
  uvec4 texels[Law_TEXELS];
  for (int t = 0; t < Law_TEXELS; ++t) texels[t] = FETCH(elements, at + t * SLICE_SIZE);
  LawEntry entry;
  for (int k = 0; k < Law_CORNERS - 1; ++k) entry.others[k] = int(texels[k / 4][k % 4]);
#define NUMBER(k) uintBitsToFloat(texels[(Law_CORNERS - 1 + k) / 4][(Law_CORNERS - 1 + k) % 4])
  entry.law = Law_OF(NUMBER);
#undef NUMBER
  return entry;
}
#end
