// What the line search of implicit Euler needs of contact between surfaces (surface/term.glsl).
struct Term {
  uvec4 kept, pressing, touched, reachable;
  uint entries, share, longest, pressed, taken, pins, meets, unused;
  uvec4 largest;
  ivec4 high;
  uvec4 low;
};
layout(std430, binding = slot_known_term) buffer TermControl { Term term; };

/// The share of the change that contact lets through: the line search tries shares of that.
float most_share() { return uintBitsToFloat(term.share); }

/// The same of a pin: it waits for what it would be drawn through.
float most_share(float inverse_mass) {
  return most_share() * (inverse_mass == 0.0 ? uintBitsToFloat(term.pins) : 1.0);
}

/// The change of contact's energy at the first shares that are tried [J].
float touch_energy(int tried) {
  return uintBitsToFloat(term.largest[tried]) * (float(term.high[tried]) * 2048.0 + float(term.low[tried])) / 1048576.0;
}
