// Draws into the shadow map: bodies, and cloths, whose vertices are the corners of a core of 1 m.
#include "placed.glsl"

void main() { gl_Position = light_view_projection * vec4(placed_point(), 1.0); }
