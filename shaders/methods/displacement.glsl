// The displacement of each vertex since the step's start, which the sweeps work on: xyz [m], w how many things the vertex
// touched when last counted. A displacement keeps its digits in float32 where a difference of positions would lose them, and
// with them the velocity.
#ifdef ONE_GROUP
#ifdef SELF_COLLISION
#define DISPLACEMENTS 2  // a pass of contacts reads one and writes the other
#else
#define DISPLACEMENTS 1
#endif
shared vec4 displacements[DISPLACEMENTS][VERTEX_COUNT];
int copy_read = 0, copy_written = 0;
int sweep;  // of the step, from 0
vec4 displacement(uint i) { return displacements[copy_read][i]; }
void displace(uint i, vec4 d) { displacements[copy_written][i] = d; }
void displace(uint i, vec3 d) { displacements[copy_written][i].xyz = d; }
#else
READ_VEC4(displacement_read, 9);
layout(std430, binding = 3) writeonly buffer Displacement { vec4 displacement_written[]; };
uniform int sweep;  // of the step, from 0
vec4 displacement(uint i) { return FETCH(displacement_read, i); }
void displace(uint i, vec4 d) { displacement_written[i] = d; }
void displace(uint i, vec3 d) { displacement_written[i].xyz = d; }
#endif

uniform int last_sweep;
uniform float mobility;  // 1 / (1 + dt air drag): air drag as if mass were more

/// Where inertia and gravity take a free vertex, if nothing is in its way.
vec3 free_displacement(vec3 v) { return mobility * dt * (v + dt * gravity.xyz); }
