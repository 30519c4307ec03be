// Shared by every draw of one picture; server/render/renderer.cpp fills it.
#include "../slots.glsl"
layout(std140, binding = block_frame) uniform Frame {
  mat4 view_projection;        // world to clip space
  mat4 light_view_projection;  // world to the shadow map's clip space
  vec4 eye;                    // xyz [m]
  vec4 to_light;               // xyz, unit length
  vec4 framed;                 // xyz centre [m] and w radius [m] of the scene in the picture
  int clear;                   // 1: the picture has no background
};
