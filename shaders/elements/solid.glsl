// The solids that cloth meets. Each kind is everything within a radius of a core: of a point (sphere), or of the
// half-space behind a plane through the point whose normal is the direction (plane). A vertex is stopped by a swept
// test (Bridson, Fedkiw & Anderson 2002, section 4), so that a fast one does not pass through.
// In the common subset of GLSL and C++ (see types.glsl, elements.h). Needs contact.glsl.

/// The kinds, in the order of scene::Shape.
const int solid_sphere = 0;
const int solid_plane = 1;
const int solid_kinds = 2;

/// Place of a solid at one time.
struct Solid {
  vec3 point;      // [m]
  vec3 direction;  // turns with it: a plane's unit normal; (0, 0, 0) if the kind has none
  real radius;     // [m], including the distance kept from its surface
};

/// Depth of x below the surface of a plane, the end of a half-space thickened by `radius` [m]; less than 0 outside.
FUNCTION real plane_depth(Solid plane, vec3 x) { return plane.radius - dot(x - plane.point, plane.direction); }

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
  return false;
}
