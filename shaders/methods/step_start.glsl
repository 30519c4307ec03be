// Where a vertex was when the step began [m]. Needs start_position, from which implicit Euler's equations start.
#ifdef BDF2
READ_VEC4(before_position, unit_before_position);
vec3 step_start(int i) { return FETCH(before_position, i).xyz; }
#else
vec3 step_start(int i) { return FETCH(start_position, i).xyz; }
#endif
