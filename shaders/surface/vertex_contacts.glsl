// What contact knows of each vertex. `first`, `backing` and `sharing` are 0 before a step, or piece of one, the last
// four before each pass of the filter.
struct VertexContacts {
  uint first;       // of the contacts that touch it: contact_links, by number + 1; 0: none
  uint touched;     // not of this vertex: the list of those that contacts touch, in any order
  uint backing;     // how firmly solids that press back it (surface.glsl)
  uint sharing;     // sum of the weights of the pairs that share it [1 / weight_units]
  int impulse[3];   // of the filter [units of speed]
  uint shortening;  // pairs that shorten its step
};
layout(std430, binding = slot_vertex_contacts) buffer AtVertices { VertexContacts at_vertex[]; };
