// The elements at each vertex: for each law a list of (element, corner), in slices of SLICE_SIZE vertices. The lists of
// a slice are padded to its longest one (sliced ELLPACK: Monakov et al. 2010), so that neighbouring threads read
// neighbouring entries. server/sim/element_lists.h makes the lists. Needs vertex_count. A kernel gathers with
//   #each Law
//     for (EntryRange at = entry_range(Law_LIST, i); at.first < at.end; at.first += Law_TEXELS * SLICE_SIZE) {
//       LawEntry entry = Law_ENTRY(at.first);
//       ...
//   #end
// server/gl/program.h repeats this for each law of which the scene has elements, and puts its name in place of Law.
#include "types.glsl"
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
