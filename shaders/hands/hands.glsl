// What hands hold (server/sim/hands.h): one entry for each held vertex, each vertex once. A kernel reads and writes
// its own vertex only.
#include "../slots.glsl"
layout(local_size_x = GROUP_SIZE) in;
struct Held {
  vec4 pull;     // xyz: where the hand would have the vertex [m]; w: stiffness over mass [1/s^2]
  vec3 numbers;  // damping over mass [1/s], most distance that pulls [m], inverse mass [1/kg]
  uint vertex;
};
layout(std430, binding = slot_held) readonly buffer HeldVertices { Held held[]; };
layout(std430, binding = slot_held_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_held_velocity) buffer Velocity { vec4 velocity[]; };
uniform int held_count;
