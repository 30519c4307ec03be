// Spheres and planes: stops a vertex's step at their surface. The same order as in the scene, spheres first.
#include "../elements/contact.glsl"
#include "../rarely.glsl"

#if SPHERE_COUNT > 0
uniform vec4 sphere[SPHERE_COUNT];          // centre at home [m], radius + margin [m]
uniform vec3 sphere_surface[SPHERE_COUNT];  // friction, restitution, motion
#endif
#if PLANE_COUNT > 0
uniform vec4 plane_point[PLANE_COUNT];    // a point of it at home [m], margin [m]
uniform vec3 plane_normal[PLANE_COUNT];
uniform vec3 plane_surface[PLANE_COUNT];
#endif

vec3 at_step(int motion, int row, vec3 home) {
  vec3 there = home;
  RARELY(motion >= 0) there = placed(motion, row, home);
  return there;
}

void meet_surface(int motion, vec3 surface, vec3 normal, vec3 x, inout vec3 v) {
  vec3 moving = vec3(0.0);
  RARELY(motion >= 0) moving = velocity_at(motion, END_ROW, x);
  v = moving + contact_velocity(v - moving, normal, surface.x, surface.y);
}

/// Mends the step from -> x with end velocity v. Returns the number of colliders met.
int resolve_colliders(vec3 from, inout vec3 x, inout vec3 v) {
  int contacts = 0;
#if SPHERE_COUNT > 0
  for (int i = 0; i < SPHERE_COUNT; ++i) {
    int motion = int(sphere_surface[i].z);
    vec3 centre = at_step(motion, END_ROW, sphere[i].xyz);
    vec3 start = from - at_step(motion, 0, sphere[i].xyz), end = x - centre;
    float within_reach = sphere[i].w + distance(start, end);
    RARELY(dot(start, start) <= within_reach * within_reach) {
      vec3 stopped, normal;
      if (sphere_contact(start, end, sphere[i].w, stopped, normal)) {
        x = centre + stopped;
        meet_surface(motion, sphere_surface[i], normal, x, v);
        ++contacts;
      }
    }
  }
#endif
#if PLANE_COUNT > 0
  for (int i = 0; i < PLANE_COUNT; ++i) {
    int motion = int(plane_surface[i].z);
    vec3 normal = motion < 0 ? plane_normal[i] : turned(motion, END_ROW, plane_normal[i]);
    float depth = plane_point[i].w - dot(x - at_step(motion, END_ROW, plane_point[i].xyz), normal);
    if (!(depth > 0.0)) continue;
    x += depth * normal;
    meet_surface(motion, plane_surface[i], normal, x, v);
    ++contacts;
  }
#endif
  return contacts;
}
