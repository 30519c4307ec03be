// The outcome of implicit Euler's line search: which share of a Newton step is taken. Needs implicit_total.glsl, and
// with CONTACT_TERM implicit_term.glsl.

/// The largest share that the next smaller one does not beat: by a hundredth, as rounding must not decide; and by a
/// half where contact makes further Newton steps, which find the rest sooner than a shorter way does. `found`: the
/// totals of what implicit_search.comp writes.
#ifdef CONTACT_TERM
const float beaten_by = 0.5;
#else
const float beaten_by = 0.01;
#endif
float best_share(vec4 found[SUMS]) {
  float energy[SHARES];
  for (int k = 0; k < SHARES; ++k) energy[k] = found[k / 4][k % 4];
#ifdef CONTACT_TERM
  const int tried = 4;  // surface/term_shares.glsl
  float one = touch_energy(tried - 2) / shares[tried - 2], other = touch_energy(tried - 1) / shares[tried - 1];
  float curvature = (one - other) / (shares[tried - 2] - shares[tried - 1]);
  for (int k = 0; k < SHARES; ++k)  // at smaller shares by the parabola through the last two
    energy[k] += k < tried ? touch_energy(k) : shares[k] * (other + curvature * (shares[k] - shares[tried - 1]));
#endif
  int k = 0;
  while (k + 1 < SHARES && !(energy[k] <= energy[k + 1] + beaten_by * abs(energy[k + 1]))) ++k;
  return shares[k];
}
