// BDF2, the second backward differentiation formula (Choi & Ko 2002, section 5). With steps of h, x and v at the end of
// the step, and those at its start and a step before it,
//   x = (4 x_n - x_(n-1)) / 3 + 2/3 h v,   v = (4 v_n - v_(n-1)) / 3 + 2/3 h a(x, v).
// That is a step of implicit Euler, x = x_0 + dt v, v = v_0 + dt a(x, v), with
//   dt = 2/3 h,   x_0 = x_n + (x_n - x_(n-1)) / 3,   v_0 = v_n + (v_n - v_(n-1)) / 3.
// So implicit Euler's kernels do it, from x_0 and v_0, which are no state that the cloth has been in, and with that dt.
// Elastic forces k, damping c, the air's drag d and friction are in its matrix as there: m (1 + dt d) + dt c + dt^2 k,
// and damping and drag act on v, which is the formula's derivative of the places, (3 x - 4 x_n + x_(n-1)) / (2 h). Of a
// pin whose places are given, too.
//
// The formula holds where the motion is smooth. What a step has not solved for itself, as what the strain limit adds
// after it, is left out of both differences: an impulse then acts once, and not, in the long run, one and a half times.
// Without a smooth step before it a step is one of implicit Euler: `history_share` is 0 then, and dt is h.
#ifdef BDF2
// For each vertex two: its way in the last step [m], and in w what it touched; its gain of velocity in it [m/s].
READ_VEC4(history, unit_history);
uniform float history_share;  // of the last step's way and gain: 1/3, or 0

/// x_0 and v_0, of x_n and v_n.
vec3 origin_of(int i, vec3 x) { return x + history_share * FETCH(history, 2 * i).xyz; }
vec3 carried_on(int i, vec3 v) { return v + history_share * FETCH(history, 2 * i + 1).xyz; }
#else
vec3 origin_of(int i, vec3 x) { return x; }
vec3 carried_on(int i, vec3 v) { return v; }
#endif
