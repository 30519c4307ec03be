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

// Of the surface met last: its unit normal, its velocity [m/s] there, friction, restitution.
vec3 met_normal, met_velocity;
vec2 met_surface;
/// What friction takes from the step's displacement [m]: left to the caller, as not all go by the velocity given.
vec3 met_braking;

#ifdef SECOND_VELOCITY
vec3 second_velocity;  // of the same vertex: what a contact does to the one it does to this, too
#endif

vec3 at_step(int motion, int row, vec3 home) {
  vec3 there = home;
  RARELY(motion >= 0) there = placed(motion, row, home);
  return there;
}

void meet_surface(int motion, vec3 surface, vec3 normal, vec3 from, vec3 x, inout vec3 v) {
  vec3 moving = vec3(0.0);
  RARELY(motion >= 0) moving = velocity_at(motion, END_ROW, x);
  met_normal = normal;
  met_velocity = moving;
  met_surface = surface.xy;
  met_braking += contact_braking(x - met_braking - from - dt * moving, v - moving, normal, surface.x, surface.y);
  v = moving + contact_velocity(v - moving, normal, surface.x, surface.y);
#ifdef SECOND_VELOCITY
  second_velocity = moving + contact_velocity(second_velocity - moving, normal, surface.x, surface.y);
#endif
}

/// Mends the step from -> x with end velocity v; colliders are thicker by `reach` [m]. Returns the number of them met.
int resolve_colliders(vec3 from, inout vec3 x, inout vec3 v, float reach) {
  int contacts = 0;
  met_braking = vec3(0.0);
#if SPHERE_COUNT > 0
  for (int i = 0; i < SPHERE_COUNT; ++i) {
    int motion = int(sphere_surface[i].z);
    vec3 centre = at_step(motion, END_ROW, sphere[i].xyz);
    vec3 start = from - at_step(motion, 0, sphere[i].xyz), end = x - centre;
    float radius = sphere[i].w + reach, within_reach = radius + distance(start, end);
    RARELY(dot(start, start) <= within_reach * within_reach) {
      vec3 stopped, normal;
      if (sphere_contact(start, end, radius, stopped, normal)) {
        x = centre + stopped;
        meet_surface(motion, sphere_surface[i], normal, from, x, v);
        ++contacts;
      }
    }
  }
#endif
#if PLANE_COUNT > 0
  for (int i = 0; i < PLANE_COUNT; ++i) {
    int motion = int(plane_surface[i].z);
    vec3 normal = motion < 0 ? plane_normal[i] : turned(motion, END_ROW, plane_normal[i]);
    float depth = plane_point[i].w + reach - dot(x - at_step(motion, END_ROW, plane_point[i].xyz), normal);
    if (!(depth > 0.0)) continue;
    x += depth * normal;
    meet_surface(motion, plane_surface[i], normal, from, x, v);
    ++contacts;
  }
#endif
  return contacts;
}
