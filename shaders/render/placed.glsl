// Places the mesh of a body: the corners of its core, then outwards by its radius.
#include "frame.glsl"

layout(location = attribute_position) in vec3 corner;     // of the core, in units of its extent
layout(location = attribute_normal) in vec3 direction;    // outwards, unit length
layout(location = uniform_placed) uniform vec4 placed;    // xyz middle [m], w radius [m]
layout(location = uniform_axes) uniform mat3 axes;        // the body's, unit length
layout(location = uniform_extent) uniform vec3 extent;    // half of the core's edges [m]

vec3 placed_point() { return placed.xyz + axes * (extent * corner + placed.w * direction); }
