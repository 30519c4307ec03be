// The shares of the way at which the energy of contact is tried, as shares of what may be taken: the first of those
// that implicit Euler's line search tries.
const vec4 tried = vec4(1.0, 0.5, 0.25, 0.125);
