// Validity of the listed pairs, in one work group: asks for a search if two blocks of triangles have come so much
// nearer to each other that a pair which the last search left out may be near now. Motion that both share does not
// count, neither a falling cloth's nor a swinging one's. A pair that was left out was farther apart than the search
// reached, and no nearer than the spheres about its blocks; it came nearer by no more than two of its corners did.
#include "surface.glsl"
READ_VEC4(block_motions, unit_block_motions);
uniform int block_count;        // at most GROUP_SIZE
uniform int cloth_block_count;  // those of bodies come after them, and do not meet each other
uniform float most_skin;        // [m]

const float rounding = 1.001;

// A wide skin makes searches rare but lists long, and every step reads the lists. Few pairs are read in less time than
// a search takes. The more there are, the sooner the next search should be due; and lists that stay valid for much
// longer than that are made anew, with a narrower skin.
const uint few_pairs = 4096u;
const float least_share = 0.0625;  // of the widest skin
float wanted_checks() { return clamp(2e5 / float(known.pairs), 3.0, 24.0); }

/// A block: all its vertices were within `radius` of `place` at the last search. Now they are where `turn` about that
/// place, which then goes to `moved`, takes them, but for `bend`; and where the shift `motion` takes them, but for
/// `change`. [m]
struct Block {
  vec3 place, moved, motion;
  float radius, bend, change;
  mat3 turn;
};

Block block_at(int i) {
  vec4 place = FETCH(block_motions, 6 * i), moved = FETCH(block_motions, 6 * i + 1);
  vec4 motion = FETCH(block_motions, 6 * i + 2);
  mat3 rows = mat3(FETCH(block_motions, 6 * i + 3).xyz, FETCH(block_motions, 6 * i + 4).xyz,
                   FETCH(block_motions, 6 * i + 5).xyz);
  return Block(place.xyz, moved.xyz, motion.xyz, place.w, moved.w, motion.w, transpose(rows));
}

/// By how much a vertex of one block and one of the other have come nearer to each other, at most [m]. A rotation of
/// both changes no distance.
float approach(Block one, Block other) {
  vec3 between = other.place - one.place, now = other.moved - one.moved;
  mat3 turned = other.turn - one.turn;
  // The Frobenius norm of the difference of two rotations is sqrt(2) times its largest stretch.
  float twist = sqrt(0.5 * (dot(turned[0], turned[0]) + dot(turned[1], turned[1]) + dot(turned[2], turned[2])));
  float as_one = length(now - one.turn * between) + twist * other.radius;
  float as_other = length(now - other.turn * between) + twist * one.radius;
  float as_rigid = min(as_one, as_other) + one.bend + other.bend;
  float as_shifted = length(other.motion - one.motion) + one.change + other.change;
  return min(as_rigid, as_shifted);
}

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

void main() {
  int block = int(gl_LocalInvocationID.x);
  if (block == 0) {
    control.next_skin = floatBitsToUint(next_skin());
    ++control.checks;
  }
  if (block < block_count && (!valid(block) || too_long()))
    control.rebuild_groups = uint((max(vertex_count, triangle_count) + GROUP_SIZE - 1) / GROUP_SIZE);
}
