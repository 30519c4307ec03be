// Contact between surfaces (kind "surface"): pairs of a vertex and a triangle, and of two edges, of all triangles of a
// scene. A search lists the pairs that can meet until parts of the surfaces have moved too far relative to each other
// (blocks.comp). After a step of any method the near ones among them push each other apart
// (elements/surface.glsl); then a filter shortens the steps of vertices so that no pair meets, which keeps a state
// without intersections so. All sums are of integers, so that no outcome depends on the order of threads. Beside each
// stands why it cannot overflow.
//
// Software OpenGL runs all the code of a kernel for all its items, both sides of an `if` and the body of a loop that no
// item enters. So what few items need is a kernel of its own, over a list of these items.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "../elements/types.glsl"
#include "../elements/contact.glsl"
#include "../elements/surface.glsl"

struct StepCounts {  // there are two: steps take turns
  uint kept_groups, kept_groups_y, kept_groups_z;              // over the listed pairs that may be near
  uint near_groups, near_groups_y, near_groups_z;              // over the near pairs
  uint vertex_groups, vertex_groups_y, vertex_groups_z;        // over the vertices, if a pair is near
  uint touching_groups, touching_groups_y, touching_groups_z;  // over the near pairs that push
  uint pushed_groups, pushed_groups_y, pushed_groups_z;        // over the vertices that they touch
  uint meeting_groups, meeting_groups_y, meeting_groups_z;     // over the near pairs that could meet
  uint cut_vertices, cut_vertices_y, cut_vertices_z;           // over the vertices, if a step is shortened
  uint near;                                                   // near pairs
  uint touching;                                               // of these, those that push
  uint meeting;                                                // of these, those that could meet
  uint cuts;                                                   // vertices whose steps were shortened
  uint touched;                                                // vertices that the pairs which push touch
  uint kept;                                                   // listed pairs that may be near
  uint unused;
};

// Set by the GPU: arguments of indirect dispatches, and what a search found (server/sim/surface_control.h). Laid out
// alike for std430 and std140.
struct Control {
  StepCounts step_counts[2];
  uint rebuild_groups, rebuild_groups_y, rebuild_groups_z;  // over triangles and vertices
  uint leaf_groups, leaf_groups_y, leaf_groups_z;           // over bundles of pairs of leaves
  uint bundle_groups, bundle_groups_y, bundle_groups_z;     // over pairs of bundles
  uint split_groups, split_groups_y, split_groups_z;        // over pairs of triangles
  uint pair_groups, pair_groups_y, pair_groups_z;           // over pairs
  uint neighbour_groups, neighbour_groups_y, neighbour_groups_z;  // over pairs of neighbours
  uint candidate_groups, candidate_groups_y, candidate_groups_z;  // over pairs whose boxes are near
  uint check_groups, check_groups_y, check_groups_z;              // 1 while a part of the step is left (advance.comp)
  uint contact_groups, contact_groups_y, contact_groups_z;        // over pairs, the same
  uint rest_groups, rest_groups_y, rest_groups_z;                 // over pairs, in a search
  uint finish_groups, finish_groups_y, finish_groups_z;           // 1 in a search
  uint leaf_pairs;           // found by the search
  uint bundle_pairs;         // the same
  uint triangle_pairs;       // the same
  uint candidates;           // the same
  uint pairs;                // the same
  uint fastest;              // longest piece of a step since the last search that was long for it [m], as bits
  uint fastest_vertex;       // its speed at the search [m/s], as bits
  uint query;                // pairs nearer than this can be near within a step [m], as bits
  uint flat_query;           // the same of pairs that no force keeps apart
  uint overflow;             // 1: a list had no room for all pairs, and nothing may move
  uint rebuilds;
  uint cuts;                 // vertices whose steps were shortened, over all steps
  uint forced;               // over all steps: pins that waited; pairs that bodies took over the plane between them;
                             // vertices that the filter kept where a solid came over them; vertices of bodies that
                             // went farther than the listed pairs allow; and not_taken
  uint not_taken;            // steps, over all, that were not taken, or not to their end, as pairs were not known
  uint most_leaf_pairs;      // found by any search
  uint most_bundle_pairs;    // the same
  uint most_triangle_pairs;  // the same
  uint most_pairs;           // the same
  uint longest;              // longest way of a vertex in this step [m], as bits
  uint longest_of_bodies;    // the same of a vertex of a body
  uint gone;                 // share of the step that it has gone before this piece, as bits of a float
  uint part;                 // share of the step that this piece goes, the same
  uint skin;                 // by how much the last search reached farther than it had to [m], as bits
  uint next_skin;            // the same of a search that is due (blocks.comp)
  uint ahead;                // how far ahead the last search looked [s], as bits
  uint next_ahead;           // the same of a search that is due (blocks.comp)
  uint since;                // time since the last search [s], as bits
  uint checks;               // of the listed pairs since the last search
};
layout(std430, binding = slot_surface_control) coherent buffer SurfaceControl { Control control; };
// The same memory, for what the kernel that reads it does not change: on software OpenGL reading a storage buffer takes
// many times as long.
layout(std140, binding = slot_known_control) uniform KnownControl { Control known; };

// Of cloths, and after them of bodies, whose vertices nothing stops. What a step changes: all vertices if a body moves,
// else those of cloths.
uniform int vertex_count, triangle_count, cloth_vertex_count, cloth_triangle_count, changing_vertex_count;
uniform float dt;           // [s]
#include "../methods/step_time.glsl"
uniform float thickness;    // [m]
uniform float most_query;   // [m]
uniform float least_query;  // [m]
uniform uint pair_capacity, triangle_pair_capacity, bundle_pair_capacity, leaf_pair_capacity;
uniform int neighbour_pair_count;
uniform int piece_count;    // most pieces in which a step is gone (advance.comp)
uniform int turn;           // whose step_counts this step has

const uint edges_bit = 0x80000000u;     // of a pair's first corner: two edges
const uint no_force_bit = 0x80000000u;  // of its second: side by side, or too near, at rest: not kept apart
const uint flat_bit = 0x80000000u;      // of a triangle pair's second: side by side at rest, and near
const uint corner_mask = 0x7fffffffu;

/// How far a vertex may go in a step, as a share of the query radius: two that are farther apart cannot meet.
const float step_share = 0.49;

/// Query radius of the search under way [m], of pairs that no force keeps apart: for the filter alone. The longest step
/// or piece of one is at most 0.79 of what a vertex may go then.
float next_flat_query() {
  float expected = dt / float(piece_count) * uintBitsToFloat(known.fastest_vertex);
  float longest = max(expected, uintBitsToFloat(known.fastest));
  return min(max(least_query, 2.6 * longest), most_query);
}
/// The same of pairs that forces keep apart.
float next_query() { return max(next_flat_query(), min(1.2 * thickness, most_query)); }
/// How near pairs are that the search lists [m].
float reach_of(float query_radius) { return query_radius + uintBitsToFloat(known.next_skin); }

/// False: not all pairs that can meet are known, as a list has no room for them, or none was searched. Then nothing may
/// move.
bool pairs_are_known() { return known.overflow == 0u && uintBitsToFloat(known.flat_query) > 0.0; }

/// How far a pair is kept apart [m], by the weights of its nearest points: within the triangle, or within both edges,
/// the thickness. At a rim another pair is nearer, or will be: slanting pushes between flat layers would brake their
/// sliding. But at the corners of bodies no other is, and their rims keep half of the thickness.
float kept_apart(uvec4 corner, vec4 weight) {
  if (all(notEqual(weight, vec4(0.0)))) return thickness;
  return int(max(corner.x, corner.w)) >= cloth_vertex_count ? 0.5 * thickness : 0.0;
}

/// Integers in which the weights of a vertex's pairs are counted. As a weight is at most 1, and no list has more than
/// 2^21 pairs (server/sim/surface_pairs.cpp: most_listed), no sum is beyond 2^31.
const float weight_units = 1024.0;
uint weight_in_units(float weight) { return uint(ceil(abs(weight) * weight_units)); }

/// What rounding may add to a corner's place, and to what is computed of it [m].
float rounding_at(vec3 x, float size) { return 2.5e-7 * max(abs(x.x), max(abs(x.y), abs(x.z))) + 1e-6 * size; }

// What a pair pushes (forces.comp, apply.comp): nothing; both parts, whose corners take their shares by inverse mass
// and weight, which keeps momentum; or one part, as the other gives no way. That is a positive number for the first
// part (whose weights are positive), a negative one for the second; the other part's backing is added to its size.
const float no_push = 0.0, pushes_both = 1.0, pushes_one = 2.0;

// A solid or body that moves against cloth backs the layer that it meets: that pushes the next layer as if its own mass
// were infinite, and backs it, one less firmly; and so on. So few passes get many layers out of the way. A solid or
// body that they are pressed against backs those that it bears. ("Shock propagation": Guendelman, Bridson and Fedkiw,
// 2003.)
const uint most_backing = 16u;     // of a vertex
const float least_pressing = 0.1;  // speed at which a solid or body comes nearer, if it presses [m/s]

bool is_edges(uvec4 pair) { return (pair.x & edges_bit) != 0u; }
uvec4 corners_of(uvec4 pair) { return pair & corner_mask; }
