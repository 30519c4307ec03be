// The length of a step [s]. BDF2 solves implicit Euler's equations with another time in its place, which its kernels
// have as dt (bdf2.glsl). Needs dt.
#ifndef whole_dt
#ifdef BDF2
uniform float step_length;
#define whole_dt step_length
#else
#define whole_dt dt
#endif
#endif
