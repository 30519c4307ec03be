// Adds a pair that presses to those of an iterate, linked at the vertices that it touches. Needs term.glsl and
// term_radius.glsl.
layout(std430, binding = slot_term_pairs) writeonly buffer Pairs { uvec4 pairs[]; };  // term.glsl
// x: the vertex's last link + 1, y: how many.
layout(std430, binding = slot_term_vertices) coherent buffer Vertices { uvec2 at_vertex[]; };
layout(std430, binding = slot_term_links) writeonly buffer Links { uvec2 links[]; };  // by 4 * pair + corner: the next
layout(std430, binding = slot_term_touched) writeonly buffer Touched { uint touched[]; };
uniform uint term_capacity; // pairs that there is room for
uniform int first;          // 1: the iterate is where the step begins, and nothing has slid yet
uniform float last_share;   // of the way to the last iterate's target, what was taken; 0: there was none

struct Pressing {
  uvec4 pair, corner;
  vec4 weight, inverse_mass;
  vec3 n;
  float gap, radius, least;  // [m]; the least gap that rounding lets tell from none
  float stiffness, friction;
  vec3 moved;     // the first part against the second, in the step so far [m]
  vec3 expected;  // the same in the whole step, with the velocities that it begins with [m]
  vec3 last;      // the same by the last iterate's change [m]
  vec3 to_come;   // what bodies have yet to bring of it [m/s]
};

void add(Pressing p) {
  APPEND(pressing, slot)
  if (slot >= term_capacity) return;
  vec3 slid = p.moved - p.n * dot(p.moved, p.n);
  float force = contact_force(p.gap, p.radius, p.stiffness), slides = p.friction * force;
  // What slid in the last step slides on: friction is taken from the way that it then goes. If it were taken to be
  // held, each step would have to find out anew.
  if (first != 0) slid = p.expected - p.n * dot(p.expected, p.n);
  float still = still_way(slides, p.inverse_mass, p.least), way = length(slid);
  // Friction that slides has no stiffness along its way. But where the last change has turned it back, or may do so if
  // another one as long follows, it needs one: or iterates go to and fro past the place where it holds.
  float growth = dot(p.last, slid) / max(way * way, still * still);
  float slides_on = clamp(min(1.0 + growth, 3.0 - 2.0 * growth), 0.0, 1.0);
  float rubs = slides * friction_stiffness(way, still);
  float excess = 0.99 * slides_on * slides * friction_excess(way, still);
  vec3 braked = (first != 0 ? excess : rubs) * slid;
  uint at = pair_texels * slot;
  pairs[at] = p.pair;
  pairs[at + 1u] = floatBitsToUint(vec4(p.n, contact_stiffness(p.gap, p.radius, p.stiffness)));
  pairs[at + 2u] = floatBitsToUint(p.weight);
  pairs[at + 3u] = floatBitsToUint(vec4(force * p.n - braked, rubs));
  pairs[at + 4u] = floatBitsToUint(vec4(slid, slides));
  pairs[at + 5u] = floatBitsToUint(vec4(p.to_come, excess));
  for (int k = 0; k < 4; ++k)
    if (p.inverse_mass[k] > 0.0 && p.weight[k] != 0.0) {
      uint link = 4u * slot + uint(k), next = atomicExchange(at_vertex[p.corner[k]].x, link + 1u);
      links[link] = uvec2(next, 0u);
      if (atomicAdd(at_vertex[p.corner[k]].y, 1u) == 0u) {
        APPEND(touched, place)
        touched[place] = p.corner[k];
      }
    }
}
