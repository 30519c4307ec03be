// What every draw of one picture shares; filled by server/render/renderer.cpp.
#include "../slots.glsl"
layout(std140, binding = block_frame) uniform Frame {
  mat4 view_projection;        // world to clip space
  mat4 light_view_projection;  // world to the shadow map's clip space
  vec4 eye;                    // xyz [m]
  vec4 to_light;               // xyz, unit length
  vec4 framed;                 // xyz centre of what the picture shows [m], w its radius [m]
};
