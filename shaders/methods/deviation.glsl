// How far each vertex has moved since the step's start. Sweeps work on it as a deviation from where inertia and gravity
// alone would take the vertex: xyz [m], w the number of things it touched at the last count. A difference of positions
// would lose its digits in float32, and with them the velocity; a deviation keeps those of the acceleration, too.
#ifdef ONE_GROUP
#ifdef SELF_COLLISION
#define DEVIATIONS 2  // a pass of contacts reads one and writes the other
#else
#define DEVIATIONS 1
#endif
shared vec4 deviations[DEVIATIONS][VERTEX_ROOM];
int copy_read = 0, copy_written = 0;
int sweep;  // number of the sweep in the step, from 0
vec4 deviation(uint i) { return deviations[copy_read][i]; }
void set_deviation(uint i, vec4 d) { deviations[copy_written][i] = d; }
void set_deviation(uint i, vec3 d) { deviations[copy_written][i].xyz = d; }
#else
READ_VEC4(deviation_read, unit_deviation);
layout(std430, binding = slot_deviation) writeonly buffer Deviation { vec4 deviation_written[]; };
uniform int sweep;  // number of the sweep in the step, from 0
vec4 deviation(uint i) { return FETCH(deviation_read, i); }
void set_deviation(uint i, vec4 d) { deviation_written[i] = d; }
void set_deviation(uint i, vec3 d) { deviation_written[i].xyz = d; }
#endif

/// What a vertex's position [m] and velocity [m/s] lost by rounding to float32 at the end of the last step. Carried on,
/// it keeps many small steps from adding up their roundings (compensated summation: Kahan 1965), which are the same in
/// every step of a fall. Only the vertex itself reads them.
struct Remainder { vec4 position, velocity; };
#ifdef WIND
coherent  // VBD keeps a vertex's added inertia in position.w, which another thread may read
#endif
layout(std430, binding = slot_remainders) buffer Remainders { Remainder remainders[]; };
uniform int last_sweep;
uniform float mobility;  // 1 / (1 + dt air drag): air drag acts like more mass

/// Displacement [m] by velocity v [m/s] alone. v may also be the difference of two vertices' velocities: gravity moves
/// both alike.
vec3 drift(vec3 v) { return (mobility * dt) * v; }
vec3 free_displacement(vec3 v) { return drift(v + dt * gravity.xyz); }
/// The deviation that the carried remainders give if nothing is in the vertex's way.
vec3 remainder(int i) { return remainders[i].position.xyz + drift(remainders[i].velocity.xyz); }
