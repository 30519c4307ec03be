// Draws into the shadow map. A sphere is the unit sphere, placed here; a cloth is in place already.
#include "frame.glsl"

layout(location = attribute_position) in vec3 position;
layout(location = uniform_placed) uniform vec4 placed;  // xyz centre [m], w scale

void main() { gl_Position = light_view_projection * vec4(placed.xyz + placed.w * position, 1.0); }
