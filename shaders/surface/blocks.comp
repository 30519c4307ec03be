// Validity of the listed pairs, in one work group: asks for a search if two blocks of triangles have come so much
// nearer to each other than the last search expected that a pair which it left out may be near now. What keeps its
// velocity was expected, and motion that both share does not count. Had all gone as expected, a pair that was left out
// would be farther apart than the search reached, and no nearer than the spheres about its blocks. It is nearer than
// that by no more than two of its corners are.
#include "surface.glsl"
READ_VEC4(block_motions, unit_block_motions);
uniform int block_count;        // at most GROUP_SIZE
uniform int cloth_block_count;  // those of bodies come after them, and do not meet each other
uniform float most_skin;        // [m]
uniform float later;            // 0: a check of the present places, which counts [s]

const float rounding = 1.001;

// A wide skin makes searches rare but lists long, and every step reads the lists. Few pairs are read in less time than
// a search takes. The more there are, the sooner the next search should be due; and lists that stay valid for much
// longer than that are made anew, with a narrower skin.
const uint few_pairs = 4096u;
const float least_share = 0.0625;  // of the widest skin
float wanted_checks() { return clamp(2e5 / float(known.pairs), 3.0, 24.0); }

/// A block: the search expected all its vertices within `radius` of `place` now. Each is where the shift `motion` takes
/// it from where it was expected, but for `change`. [m]
struct Block {
  vec3 place, motion;
  float radius, change;
};

Block block_at(int i) {
  vec4 place = FETCH(block_motions, 2 * i), motion = FETCH(block_motions, 2 * i + 1);
  return Block(place.xyz, motion.xyz, place.w, motion.w);
}

/// By how much a vertex of one block and one of the other have come nearer to each other than expected, at most [m].
float approach(Block one, Block other) { return length(other.motion - one.motion) + one.change + other.change; }

/// True if no pair of this block and another can be near that is not listed.
bool valid(int i) {
  Block one = block_at(i);
  bool all_valid = true;
  // Each two blocks once: every block looks at the half of the ring that begins with itself.
  for (int k = 0; k <= block_count / 2; ++k) {
    int j = i + k < block_count ? i + k : i + k - block_count;
    Block other = block_at(j);
    float apart = length(other.place - one.place) - one.radius - other.radius;
    float room = max(apart - uintBitsToFloat(known.query), uintBitsToFloat(known.skin));
    bool may_meet = i < cloth_block_count || j < cloth_block_count;
    all_valid = all_valid && (!may_meet || rounding * approach(one, other) <= room);
  }
  return all_valid;
}

/// True if the lists are longer than they need be.
bool too_long() {
  return known.pairs > few_pairs && float(known.checks) >= 4.0 * wanted_checks() &&
         uintBitsToFloat(known.skin) > 2.0 * least_share * most_skin;
}

float next_skin() {
  float skin = uintBitsToFloat(known.skin), lasts = float(max(known.checks, 1u));
  if (skin == 0.0 || known.pairs <= few_pairs) return most_skin;
  return clamp(skin * wanted_checks() / lasts, least_share * most_skin, most_skin);
}

const float most_steps_ahead = 24.0;
/// How far ahead the next search looks [s]: as long as this one's lists have lasted. If it looked less far, its lists
/// would be invalid sooner; if farther, they would have pairs that meet only after the next search.
float next_ahead() {
  float ahead = uintBitsToFloat(known.ahead), lasted = uintBitsToFloat(known.since);
  return min(clamp(lasted, max(0.5 * ahead, dt), max(2.0 * ahead, 4.0 * dt)), most_steps_ahead * dt);
}

void main() {
  int block = int(gl_LocalInvocationID.x);
  if (block == 0) {
    control.next_skin = floatBitsToUint(next_skin());
    control.next_ahead = floatBitsToUint(next_ahead());
    if (later == 0.0) ++control.checks;
  }
  if (block < block_count && (!valid(block) || too_long()))
    control.rebuild_groups = uint((max(vertex_count, triangle_count) + GROUP_SIZE - 1) / GROUP_SIZE);
}
