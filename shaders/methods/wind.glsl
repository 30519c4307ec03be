// Wind on a vertex: a third of the load on each of its triangles.
#ifdef WIND
#include "../elements/wind.glsl"
READ_UINT(fan_offsets, unit_fan_offsets);  // [vertex_count + 1] into the fans
READ_UVEC2(fans, unit_fans);  // for each triangle at a vertex its two other corners, counter-clockwise
uniform vec2 wind_coefficients;  // of drag, of lift

/// Load on vertex i, at x with velocity v, in air of this velocity [m/s].
WindLoad wind_on(int i, vec3 x, vec3 v, vec3 air) {
  Wind wind = Wind(wind_coefficients.x, wind_coefficients.y);
  precise vec3 force = vec3(0.0);
  precise float braking = 0.0;
  int end = int(FETCH_UINT(fan_offsets, i + 1));
  for (int at = int(FETCH_UINT(fan_offsets, i)); at < end; ++at) {
    uvec2 corners = FETCH_UVEC2(fans, at);
    precise vec3 a = FETCH(position, corners.x).xyz - x, b = FETCH(position, corners.y).xyz - x;
    precise vec3 mean = (v + FETCH(velocity, corners.x).xyz + FETCH(velocity, corners.y).xyz) / 3.0;
    WindLoad load = wind_load(wind, air - mean, cross(a, b));
    force += load.force / 3.0;
    braking += load.braking / 3.0;
  }
  WindLoad sum;
  sum.force = force;
  sum.braking = braking;
  return sum;
}

#ifndef MOST_OF_FLOW
#define MOST_OF_FLOW most_of_flow
#endif
/// The acceleration that an explicit step gives the vertex [m/s^2].
vec3 wind_acceleration(int i, vec4 x, vec3 v, vec3 air) {
  WindLoad load = wind_on(i, x.xyz, v, air);
  return load.force * (x.w * wind_share(dt, x.w, load.braking, MOST_OF_FLOW));
}
#endif
