// Contact of triangles and edges: how far apart a pair is, the push that keeps it at a distance, and how much of a step
// keeps it disjoint. Pairs are a vertex and a triangle (corners: the vertex, then the triangle's), or two edges
// (corners: the first edge's ends, then the second's). Planes that divide a pair and shorten steps: "Divide and
// Truncate" (arXiv 2604.15513). In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// Places of a pair's corners [m], relative to a point near them.
struct Corners {
  vec3 x[4];
};

/// How a pair is separated: no point of its first part is less than `gap` [m] beyond any of its second along the unit
/// vector n. The nearest points differ by the sum of weight[k] x[k]. gap 0, n 0: the two touch.
struct Separation {
  vec3 n;
  real gap;
  real weight[4];
};

/// What divides a pair along n [m].
FUNCTION real gap_along(bool edges, Corners c, vec3 n) {
  real y1 = dot(n, c.x[1]);
  real low = dot(n, c.x[0]), high = max(dot(n, c.x[2]), dot(n, c.x[3]));
  return edges ? min(low, y1) - high : low - max(high, y1);
}

/// Takes n and its weights over if they divide the pair better than `best`: rounding cannot make a gap too large then.
FUNCTION void compare(bool edges, Corners c, vec3 n, real w0, real w1, real w2, real w3, INOUT(Separation) best) {
  real gap = gap_along(edges, c, n);
  if (!(gap > best.gap)) return;
  best.n = n;
  best.gap = gap;
  best.weight[0] = w0;
  best.weight[1] = w1;
  best.weight[2] = w2;
  best.weight[3] = w3;
}

/// The same for the direction between the points that the weights give.
FUNCTION void compare_points(bool edges, Corners c, real w0, real w1, real w2, real w3, INOUT(Separation) best) {
  vec3 d = c.x[0] * w0 + c.x[1] * w1 + c.x[2] * w2 + c.x[3] * w3;
  real squared = dot(d, d);
  if (squared > real(0.0)) compare(edges, c, d * (real(1.0) / sqrt(squared)), w0, w1, w2, w3, best);
}

/// Where on the segment a b the point nearest to p is: 0 at a, 1 at b.
FUNCTION real nearest_on(vec3 p, vec3 a, vec3 b) {
  vec3 along = b - a;
  real squared = dot(along, along);
  return squared > real(0.0) ? clamp(dot(p - a, along) / squared, real(0.0), real(1.0)) : real(0.0);
}

FUNCTION Separation no_separation() {
  Separation best;
  best.n = vec3(real(0.0));
  best.gap = real(0.0);
  for (int k = 0; k < 4; ++k) best.weight[k] = real(0.0);
  return best;
}

/// Both kinds in one, with as much in common as can be: software OpenGL runs both sides of every `if`. Near-parallel
/// edges have no normal: then an end of one of them is nearest, or as near as rounding tells.
FUNCTION Separation separation(bool edges, Corners c) {
  const real one = real(1.0), zero = real(0.0);
  Separation best = no_separation();
  // A corner and a segment of the other part: the vertex and each side of the triangle, or each end of two edges.
  real u = nearest_on(c.x[0], c.x[2], c.x[3]);
  compare_points(edges, c, one, zero, u - one, -u, best);
  u = nearest_on(edges ? c.x[1] : c.x[0], edges ? c.x[2] : c.x[1], edges ? c.x[3] : c.x[2]);
  compare_points(edges, c, edges ? zero : one, edges ? one : u - one, edges ? u - one : -u, edges ? -u : zero, best);
  u = nearest_on(edges ? c.x[2] : c.x[0], edges ? c.x[0] : c.x[3], c.x[1]);
  compare_points(edges, c, edges ? one - u : one, edges ? u : -u, edges ? -one : zero, edges ? zero : u - one, best);
  u = nearest_on(c.x[3], c.x[0], c.x[1]);
  if (edges) compare_points(edges, c, one - u, u, zero, -one, best);
  // Along the normal of a triangle, or of two edges.
  vec3 along = edges ? c.x[1] - c.x[0] : c.x[2] - c.x[1], other = edges ? c.x[3] - c.x[2] : c.x[3] - c.x[1];
  vec3 normal = cross(along, other);
  real squared = dot(normal, normal), size = sqrt(squared);
  vec3 p = c.x[1] - c.x[0], q = c.x[2] - c.x[0], r = c.x[3] - c.x[0];
  real first = dot(normal, cross(edges ? other : q, edges ? -q : r));
  real second = dot(normal, cross(edges ? along : r, edges ? -q : p));
  real third = dot(normal, cross(p, q)), sum = edges ? squared : first + second + third;
  bool within = first >= zero && second >= zero && (edges ? first <= sum && second <= sum : third >= zero);
  if (within && sum > zero && (!edges || squared > real(1e-10) * dot(along, along) * dot(other, other))) {
    real side = (edges ? dot(normal, q) : dot(normal, p)) > zero ? -one : one;
    real s = first / sum, t = second / sum;
    compare(edges, c, normal * (side / size), edges ? one - s : one, edges ? s : -s, edges ? t - one : -t,
            edges ? -t : -(third / sum), best);
  }
  return best;
}

/// What friction may still take in a step: so much as the loads allow that contacts have borne in its passes so far,
/// less what it has taken.
struct FrictionLeft {
  real displacement;  // [m]
  real velocity;      // [m/s]
};

/// What a pair knows of the passes of a step so far.
struct PairLoad {
  real push;     // along its normal, that it began with and that may be taken back [m]
  real impulse;  // [m/s]
  FrictionLeft left;
};

/// What friction takes of v, a displacement or velocity whose part along n is no sliding: the share `part`, but at most
/// what is `left`.
FUNCTION vec3 rub(vec3 v, vec3 n, real part, INOUT(real) left) {
  vec3 sliding = v - n * dot(v, n);
  real size = sqrt(dot(sliding, sliding)), takes = min(part * size, left);
  if (!(takes > real(0.0))) return vec3(real(0.0));
  left -= takes;
  return sliding * (takes / size);
}

/// A pair that was `gap` [m] apart along n at the step's start, and whose nearest points have moved by `moved` [m]
/// relative to each other since, with relative velocity v [m/s]. If it is nearer than `keep` [m], then `push` [m] and
/// `impulse` [m/s] are the changes of both that keep it apart, with Coulomb friction: the `part` of them that is this
/// pair's, to be shared by its corners. Of an overlap at the step's start the share `mend` is removed, and becomes no
/// velocity. What the pair began with (PairLoad) is taken back where it is too much: nothing pulls.
/// `pushes`, `rubs`: what the pass does, or both. False: nothing changes.
FUNCTION bool surface_contact(vec3 n, real gap, vec3 moved, vec3 v, real keep, real friction, real restitution,
                              real mend, real part, bool pushes, bool rubs, INOUT(PairLoad) load, OUT(vec3) push,
                              OUT(vec3) impulse) {
  push = vec3(real(0.0));
  impulse = vec3(real(0.0));
  real wanted = gap < keep ? gap + mend * (keep - gap) : keep;
  real approach = -dot(moved, n), lacks = wanted - (gap - approach);
  bool bears = pushes && (lacks > real(0.0) || load.push > real(0.0));
  if (bears) {
    real more = max(part * lacks, -load.push), stopped = -dot(v, n);
    load.push = min(load.push, load.push + more);
    real harder = part * (stopped > real(0.0) ? (real(1.0) + restitution) * stopped : stopped);
    harder = max(lacks > real(0.0) || load.push > real(0.0) ? harder : min(harder, real(0.0)), -load.impulse);
    load.impulse = min(load.impulse, load.impulse + harder);
    push = n * more;
    impulse = n * harder;
    real carried = min(more, part * max(approach, real(0.0)));
    load.left.displacement = max(load.left.displacement + friction * carried, real(0.0));
    load.left.velocity = max(load.left.velocity + friction * harder, real(0.0));
  }
  bool brakes = rubs && (load.left.displacement > real(0.0) || load.left.velocity > real(0.0));
  if (brakes) {
    push = push - rub(moved, n, part, load.left.displacement);
    impulse = impulse - rub(v, n, part, load.left.velocity);
  }
  return bears || brakes;
}

/// Largest part of its step that a corner takes. `room` [m]: its distance from the plane that divides the pair,
/// `away` [m]: by how much its step goes away from it, `size` [m]: the step's length. `rounding` [m]: more than
/// rounding adds to a place. Any smaller part of the step is safe, too: nearer to the plane than `rounding`, a part
/// of a step that leads away only a little may be turned about by rounding, so that only steps are taken that clearly
/// lead away. `least` [m], not less than `rounding`: no step leads nearer to the plane than that, or what is
/// pressed together, and takes most of the room that is left again and again, would soon have none to move in any
/// direction. Where there is less, a step may still take a tenth of it, or nothing could slide.
FUNCTION real share_of_step(real room, real away, real size, real rounding, real least) {
  if (!(room >= rounding)) return away >= rounding && away >= real(0.1) * size ? real(1.0) : real(0.0);
  real nearest = room < least ? max(rounding, real(0.9) * room) : least;
  if (room + away >= nearest) return real(1.0);
  real meets = (room - nearest) / -away;
  return max(min(real(0.85) * meets, meets - real(1e-3)), real(0.0));
}
/// The shortest part of a step [m], in units of `rounding`, that a corner may take, but for the whole step: along a
/// tenth of it (share_of_step) rounding is too small to turn it about.
const real shortest_part = real(16.0);

/// The steps of a pair's corners along n [m]. (`held` is not bool: of an array of bool Mesa 22's zink makes SPIR-V that
/// no Vulkan driver takes.)
struct StepsAlong {
  real y[4];  // the corner's place
  real d[4];  // its step
  int held[4];  // 1: nothing may stop the corner; else 0
};

/// Where the plane is that divides a pair, along n [m]: each part may take the share of the gap that it wants to take,
/// but at least a twentieth, not nearer to either than rounding if there is room, and all that its held corners take.
FUNCTION real dividing_plane(bool edges, StepsAlong s, real rounding) {
  real low = edges ? min(s.y[0], s.y[1]) : s.y[0];
  real high = edges ? max(s.y[2], s.y[3]) : max(max(s.y[1], s.y[2]), s.y[3]);
  real first = real(0.0), second = real(0.0), first_held = real(-1.0), second_held = real(-1.0);
  for (int k = 0; k < 4; ++k) {
    bool of_first = k == 0 || (edges && k == 1);
    if (of_first) first = max(first, -s.d[k]);
    else second = max(second, s.d[k]);
    if (of_first && s.held[k] != 0) first_held = max(first_held, low - s.y[k] - s.d[k]);
    if (!of_first && s.held[k] != 0) second_held = max(second_held, s.y[k] + s.d[k] - high);
  }
  real sum = first + second;
  real share = sum > real(0.0) ? clamp(second / sum, real(0.05), real(0.95)) : real(0.5);
  real least = min(real(1.01) * rounding, real(0.5) * (low - high));
  real plane = clamp(high + share * (low - high), high + least, low - least);
  if (first_held > real(0.0)) plane = min(plane, low - first_held - real(2.0) * rounding);
  if (second_held > real(0.0)) plane = max(plane, high + second_held + real(2.0) * rounding);
  return plane;
}

/// True if the steps of a pair's corners could make it meet, or come within rounding of that.
FUNCTION bool could_meet(bool edges, StepsAlong s, real rounding) {
  real low_start = edges ? min(s.y[0], s.y[1]) : s.y[0];
  real high_start = edges ? max(s.y[2], s.y[3]) : max(max(s.y[1], s.y[2]), s.y[3]);
  real first = real(0.0), second = real(0.0);
  for (int k = 0; k < 4; ++k) {
    if (k == 0 || (edges && k == 1)) first = max(first, -s.d[k]);
    else second = max(second, s.d[k]);
  }
  return !(first + second + real(4.0) * rounding < low_start - high_start);
}
