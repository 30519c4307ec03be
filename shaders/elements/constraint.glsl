// An element as a constraint that PBD and XPBD project, under every law.
// In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// Factors of a projection, for one dt. They follow from stiffness, damping, masses and dt:
/// server/model/constraint_gains.h.
struct ConstraintGains {
  real stretch, damping;  // [kg]
  real memory;            // factor on what the element has pushed in this step so far, [0, 1)
  real turning;           // stiffness relative to the inertia of all corners, w k dt^2; 0 without memory
};
