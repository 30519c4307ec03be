// A large square of the plane around the scene in the picture; plane.frag fades it out before its edge.
#include "frame.glsl"

layout(location = uniform_point) uniform vec3 point;   // [m]
layout(location = uniform_normal) uniform vec3 normal;  // unit length

out vec3 position;

void main() {
  vec3 other = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  vec3 u = normalize(cross(other, normal)), v = cross(normal, u);
  vec3 nearest = framed.xyz - dot(framed.xyz - point, normal) * normal;
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  position = nearest + 12.0 * framed.w * (corner.x * u + corner.y * v);
  gl_Position = view_projection * vec4(position, 1.0);
}
