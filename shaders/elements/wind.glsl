// Wind on a triangle of cloth: drag along the flow, and lift across it. Both follow the flow relative to the cloth's
// own motion, so that a moving cloth is braked and never gains energy from air at rest.
// In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// Coefficients of a scene's wind.
struct Wind {
  real drag, lift;
};

/// What the wind does to a triangle, or to a vertex.
struct WindLoad {
  vec3 force;  // [N]
  /// A bound [kg/s]: the force is at most this times the speed of the flow, and so is its part along the triangle's
  /// normal against the flow's. A step that adds `braking` times the change of velocity as a resistance takes at most
  /// all of the flow's speed, however light the cloth and however long the step.
  real braking;
};

const real air_density = real(1.2);  // [kg/m^3]

/// Load on a whole triangle of area A and unit normal n, in the flow u [m/s] relative to its centre:
///   force = density A / 2 (drag |u.n| u + lift (u.n) (|u| n - (u.n) u / |u|)).
/// `crossed`: cross product of two of its edges, 2 A n [m^2]; its sign does not matter. Where the flow grazes, the
/// force goes to 0. A triangle without an area feels none.
FUNCTION WindLoad wind_load(Wind wind, vec3 u, vec3 crossed) {
  WindLoad load;
  load.force = vec3(real(0.0));
  load.braking = real(0.0);
  PRECISE real speed = sqrt(dot(u, u));
  PRECISE real doubled_area = sqrt(dot(crossed, crossed));
  if (!(speed > real(0.0)) || !(doubled_area > real(0.0))) return load;
  PRECISE vec3 n = crossed / doubled_area;
  PRECISE vec3 along = u / speed;
  PRECISE real slant = dot(along, n);  // cosine
  PRECISE real facing = max(slant, -slant);
  PRECISE real pressure = real(0.25) * air_density * doubled_area * speed;  // over a velocity [kg/s]
  PRECISE vec3 force = (pressure * wind.drag * facing) * u +
                       (pressure * wind.lift * slant * speed) * (n - slant * along);
  load.force = force;
  load.braking = pressure * (wind.drag * facing + wind.lift);
  return load;
}

/// The most of the flow's speed that an explicit step may take; and with Verlet, whose predicted velocity is ahead of
/// the one that moves the vertex.
const real most_of_flow = real(1.0);
const real most_of_flow_predicted = real(0.5);

/// The share of the wind's force that an explicit step of dt [s] lets act on a vertex: all, unless it would then take
/// more than `most` of the flow's speed.
FUNCTION real wind_share(real dt, real inverse_mass, real braking, real most) {
  return most / max(most, dt * inverse_mass * braking);
}
