// Spheres and planes: stops a vertex's step at their surface. The same order as in the scene, spheres first.
#include "../elements/contact.glsl"


#if SPHERE_COUNT > 0
layout(location = 16) uniform vec4 sphere[SPHERE_COUNT];          // centre at home [m], radius + margin [m]
layout(location = 16 + SPHERE_COUNT) uniform vec3 sphere_surface[SPHERE_COUNT];  // friction, restitution, motion
#endif
#if PLANE_COUNT > 0
layout(location = 256) uniform vec4 plane_point[PLANE_COUNT];    // a point of it at home [m], margin [m]
layout(location = 256 + PLANE_COUNT) uniform vec3 plane_normal[PLANE_COUNT];
layout(location = 256 + 2 * PLANE_COUNT) uniform vec3 plane_surface[PLANE_COUNT];
#endif

vec3 at_step(int motion, int row, vec3 home) { return motion < 0 ? home : placed(motion, row, home); }

void meet_surface(int motion, vec3 surface, vec3 normal, vec3 x, inout vec3 v) {
  vec3 moving = motion < 0 ? vec3(0.0) : velocity_at(motion, 1, x);
  v = moving + contact_velocity(v - moving, normal, surface.x, surface.y);
}

/// Mends the step from -> x with end velocity v. Returns the number of colliders met.
int resolve_colliders(vec3 from, inout vec3 x, inout vec3 v) {
  int contacts = 0;
#if SPHERE_COUNT > 0
  for (int i = 0; i < SPHERE_COUNT; ++i) {
    int motion = int(sphere_surface[i].z);
    vec3 centre = at_step(motion, 1, sphere[i].xyz);
    vec3 stopped, normal;
    if (!sphere_contact(from - at_step(motion, 0, sphere[i].xyz), x - centre, sphere[i].w, stopped, normal)) continue;
    x = centre + stopped;
    meet_surface(motion, sphere_surface[i], normal, x, v);
    ++contacts;
  }
#endif
#if PLANE_COUNT > 0
  for (int i = 0; i < PLANE_COUNT; ++i) {
    int motion = int(plane_surface[i].z);
    vec3 normal = motion < 0 ? plane_normal[i] : turned(motion, 1, plane_normal[i]);
    float depth = plane_point[i].w - dot(x - at_step(motion, 1, plane_point[i].xyz), normal);
    if (!(depth > 0.0)) continue;
    x += depth * normal;
    meet_surface(motion, plane_surface[i], normal, x, v);
    ++contacts;
  }
#endif
  return contacts;
}
