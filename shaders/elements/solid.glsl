// The solids that cloth meets. Each kind is everything within a radius of a core: of a point (sphere), of the
// half-space behind a plane through the point whose normal is the direction (plane), of a line (capsule), of a cuboid
// (box: its own radius is 0, that of the distance kept from it is not). A vertex is stopped by a swept test (Bridson,
// Fedkiw & Anderson 2002, section 4), so that a fast one does not pass through. In the common subset of GLSL and C++
// (see types.glsl, elements.h). Needs contact.glsl.

/// The kinds, in the order of scene::Shape.
const int solid_sphere = 0;
const int solid_plane = 1;
const int solid_capsule = 2;
const int solid_box = 3;
const int solid_kinds = 4;

/// Place of a solid at one time. What a kind has no use for is 0.
struct Solid {
  vec3 point;      // [m]: a plane's, else the middle
  vec3 direction;  // unit length, turns with it: a plane's normal, a body's first axis
  real radius;     // [m], including the distance kept from its surface
  vec3 second;     // a body's second axis; the third is their cross product
  vec3 extent;     // half of the edges of a body's core, along its axes [m]
};

/// True for a kind whose core is a box with axes, if one without width: a body.
FUNCTION bool solid_has_axes(int kind) { return kind == solid_capsule || kind == solid_box; }

/// Vectors of four numbers in which the kernels get a solid: friction and motion in one of them, axes and extent in the
/// last ones of a body (collide/colliders.glsl).
FUNCTION int solid_rows(int kind) { return solid_has_axes(kind) ? 4 : 3; }

/// Depth of x below the surface of a plane, the end of a half-space thickened by `radius` [m]; less than 0 outside.
FUNCTION real plane_depth(Solid plane, vec3 x) { return plane.radius - dot(x - plane.point, plane.direction); }

FUNCTION vec3 along_axes(Solid body, vec3 v) {
  return vec3(dot(v, body.direction), dot(v, body.second), dot(v, cross(body.direction, body.second)));
}

/// v after the least turn that takes one unit vector to another; unturned if they are opposite.
FUNCTION vec3 least_turn(vec3 one, vec3 other, vec3 v) {
  vec3 turn = cross(one, other), across = cross(turn, v);
  return v + across + cross(turn, across) * (real(1.0) / max(real(1.0) + dot(one, other), real(1e-6)));
}

/// A place at the step's start as a body sees it, along its axes. A capsule looks the same however it rolls, so it
/// sees no roll: a vertex on one that rolls fast would seem to cut through it.
FUNCTION vec3 seen_by(int kind, Solid before, Solid after, vec3 from) {
  vec3 v = from - before.point;
  if (kind == solid_capsule) return along_axes(after, least_turn(before.direction, after.direction, v));
  return along_axes(before, v);
}

/// Depth of x below the surface of a body, and the unit normal where the surface is nearest; less than 0 outside. x is
/// along the body's axes, as is the normal. The surface is rounded at the core's edges and corners.
FUNCTION real body_depth(vec3 extent, real radius, vec3 x, OUT(vec3) normal) {
  vec3 apart = x - max(-extent, min(extent, x));
  real squared = dot(apart, apart);
  if (squared > real(0.0)) {
    real distance_apart = sqrt(squared);
    normal = apart * (real(1.0) / distance_apart);
    return radius - distance_apart;
  }
  vec3 room = extent - max(x, -x);  // in the core: out through its nearest face
  real least = min(room.x, min(room.y, room.z));
  int axis = room.z == least ? 2 : room.y == least ? 1 : 0;
  normal = vec3(real(0.0));
  normal[axis] = x[axis] < real(0.0) ? real(-1.0) : real(1.0);
  return radius + least;
}

/// Share of a path at which it comes within `radius` of a core, 0 if it starts there; more than 1 if it never does.
/// The planes of the core thickened on all sides bound the path (slab method; Ericson 2005, "Real-Time Collision
/// Detection", section 5.3.3). What remains is to leave out its edges and corners, which are round: between the planes
/// of the core's own faces, the squared distance from the core is a quadratic function of the share.
FUNCTION real body_entry(vec3 extent, real radius, vec3 from, vec3 path) {
  const real smallest = real(1e-30);  // [m]: a shorter path counts as none
  real begin = real(0.0), end = real(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    real reach = extent[axis] + radius, way = path[axis];
    if (max(way, -way) > smallest) {
      real first = (-reach - from[axis]) / way, last = (reach - from[axis]) / way;
      begin = max(begin, min(first, last));
      end = min(end, max(first, last));
    } else if (max(from[axis], -from[axis]) > reach) {
      return real(2.0);
    }
  }
  for (int piece = 0; piece < 7; ++piece) {  // at most six planes part the path
    if (begin > end) return real(2.0);
    real next = end;
    for (int axis = 0; axis < 3; ++axis) {
      real way = path[axis];
      if (max(way, -way) > smallest) {
        real first = (-extent[axis] - from[axis]) / way, last = (extent[axis] - from[axis]) / way;
        if (first > begin) next = min(next, first);
        if (last > begin) next = min(next, last);
      }
    }
    vec3 x = from + path * begin, middle = from + path * (real(0.5) * (begin + next));
    real a = real(0.0), b = real(0.0), c = -radius * radius;
    for (int axis = 0; axis < 3; ++axis) {
      real side = middle[axis] < real(0.0) ? real(-1.0) : real(1.0);
      if (side * middle[axis] > extent[axis]) {
        real beyond = side * x[axis] - extent[axis], way = side * path[axis];
        a += way * way;
        b += beyond * way;
        c += beyond * beyond;
      }
    }
    if (!(c > real(0.0))) return begin;
    if (!(b < real(0.0))) return real(2.0);  // the distance only grows from here on
    real discriminant = b * b - a * c;
    if (discriminant >= real(0.0)) {
      real share = begin + c / (sqrt(discriminant) - b);
      if (share <= next) return share;
    }
    if (!(next < end)) return real(2.0);
    begin = next;
  }
  return real(2.0);
}

/// Contact of a path, from -> to along a body's axes, with the body. True if they meet; then the end of the path moves
/// by `push` [m] along `normal`: to where it met the body and on along the tangent plane there; or, if it was inside
/// and not on its way deeper, out by the shortest way.
FUNCTION bool body_contact(vec3 extent, real radius, vec3 from, vec3 to, OUT(real) push, OUT(vec3) normal) {
  vec3 path = to - from;
  real share = body_entry(extent, radius, from, path);
  if (share <= real(1.0)) {
    push = body_depth(extent, radius, from + path * share, normal);
    real deeper = dot(path, normal);
    push -= deeper * (real(1.0) - share);
    if (deeper < real(0.0) && push > real(0.0)) return true;
  }
  push = body_depth(extent, radius, to, normal);
  return push > real(0.0);
}

/// Depth of x below the surface of a solid of this kind [m], less than 0 outside, and the unit normal where the surface
/// is nearest. An unknown kind is nowhere.
FUNCTION real nearest_of_solid(int kind, Solid solid, vec3 x, OUT(vec3) normal) {
  vec3 from = x - solid.point;
  normal = solid.direction;
  if (kind == solid_sphere) {
    real apart = sqrt(dot(from, from));
    if (apart > real(0.0)) normal = from * (real(1.0) / apart);
    return solid.radius - apart;
  }
  if (kind == solid_plane) return plane_depth(solid, x);
  if (solid_has_axes(kind)) {
    vec3 along;
    real depth = body_depth(solid.extent, solid.radius, along_axes(solid, from), along);
    normal = solid.direction * along.x + solid.second * along.y + cross(solid.direction, solid.second) * along.z;
    return depth;
  }
  return real(-1e30);
}

FUNCTION real solid_depth(int kind, Solid solid, vec3 x) {
  vec3 normal;
  return nearest_of_solid(kind, solid, x, normal);
}

/// Share of the path from -> to at which it comes within `radius` [m] of a solid's core, which moves from `before` to
/// `after` meanwhile; 0 if it starts there, more than 1 if it never does. Of a solid that turns an estimate.
FUNCTION real solid_entry(int kind, Solid before, Solid after, vec3 from, vec3 to, real radius) {
  if (kind == solid_plane) {
    real start = dot(from - before.point, before.direction) - radius;
    real end = dot(to - after.point, after.direction) - radius;
    return start <= real(0.0) ? real(0.0) : end < real(0.0) ? start / (start - end) : real(2.0);
  }
  bool has_axes = solid_has_axes(kind);
  vec3 start = has_axes ? seen_by(kind, before, after, from) : from - before.point;
  vec3 end = has_axes ? along_axes(after, to - after.point) : to - after.point;
  return body_entry(after.extent, radius, start, end - start);  // a sphere's core has no extent
}

/// A cheap test before solid_contact: false if the path from -> to cannot meet the solid, which moves from `before` to
/// `after` meanwhile.
FUNCTION bool solid_near(int kind, Solid before, Solid after, vec3 from, vec3 to) {
  if (kind == solid_sphere) {
    vec3 start = from - before.point;
    vec3 path = start - (to - after.point);
    real within_reach = after.radius + sqrt(dot(path, path));
    return dot(start, start) <= within_reach * within_reach;
  }
  if (kind == solid_plane) return plane_depth(after, to) > real(0.0);
  if (solid_has_axes(kind)) {
    vec3 start = seen_by(kind, before, after, from), end = along_axes(after, to - after.point);
    vec3 apart = max(min(start, end), -max(start, end)) - after.extent;
    return max(apart.x, max(apart.y, apart.z)) <= after.radius;
  }
  return false;
}

/// A cheaper test, for a solid at rest: false if no point within `reach` [m] of x can meet it.
FUNCTION bool solid_within(int kind, Solid solid, vec3 x, real reach) {
  vec3 from = x - solid.point;
  real distance = solid.radius + reach;
  if (kind == solid_sphere) return dot(from, from) <= distance * distance;
  if (kind == solid_plane) return dot(from, solid.direction) <= distance;
  if (solid_has_axes(kind)) {
    vec3 along = along_axes(solid, from), apart = max(along, -along) - solid.extent;
    return max(apart.x, max(apart.y, apart.z)) <= distance;
  }
  return false;
}

/// Contact of the path from -> to [m] with a solid of this kind, which moves from `before` to `after` meanwhile. True
/// if they meet; then `stopped` is where the path ends instead, on the solid's surface or outside, and `normal` the
/// unit normal there. An unknown kind meets nothing.
FUNCTION bool solid_contact(int kind, Solid before, Solid after, vec3 from, vec3 to, OUT(vec3) stopped,
                            OUT(vec3) normal) {
  stopped = to;
  normal = vec3(real(0.0));
  if (kind == solid_sphere) {
    vec3 end;
    if (!sphere_contact(from - before.point, to - after.point, after.radius, end, normal)) return false;
    stopped = after.point + end;
    return true;
  }
  if (kind == solid_plane) {
    real depth = plane_depth(after, to);
    if (!(depth > real(0.0))) return false;
    normal = after.direction;
    stopped = to + normal * depth;
    return true;
  }
  if (solid_has_axes(kind)) {
    vec3 start = seen_by(kind, before, after, from), end = along_axes(after, to - after.point), along;
    real push;
    if (!body_contact(after.extent, after.radius, start, end, push, along)) return false;
    normal = after.direction * along.x + after.second * along.y + cross(after.direction, after.second) * along.z;
    stopped = to + normal * push;
    return true;
  }
  return false;
}
